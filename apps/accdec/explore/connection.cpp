#include "connection.hpp"

#include <algorithm>
#include <cstring>

#include <poll.h>
#include <sys/socket.h>

namespace accdec::explore {

using std::chrono::milliseconds;

bool Connection::ready(short event, milliseconds most) const {
  pollfd file{socket_, event, 0};
  return ::poll(&file, 1, static_cast<int>(std::max<milliseconds::rep>(0, most.count()))) > 0;
}

bool Connection::ended() const {
  return ready(POLLRDHUP, milliseconds(0));
}

void Connection::begin() {
  until_ = std::chrono::steady_clock::now() + head_time;
  left_ = head_bytes + body_bytes;
}

void Connection::expect_body() {
  until_ = std::chrono::steady_clock::now() + request_time;
}

bool Connection::wait(milliseconds most) const {
  return first_ < last_ || ready(POLLIN, most);
}

bool Connection::is_readable() const {
  return wait(milliseconds(0));
}

bool Connection::is_writable() const {
  return ready(POLLOUT, write_time);
}

ssize_t Connection::read(char* to, std::size_t size) {
  if (first_ == last_) {
    const auto time = std::chrono::ceil<milliseconds>(until_ - std::chrono::steady_clock::now());
    const bool allowed = left_ > 0 && time.count() > 0 && ready(POLLIN, time);
    const ssize_t got = allowed ? ::recv(socket_, buffer_.data(), std::min(buffer_.size(), left_), 0) : -1;
    failed_ = got <= 0;
    if (failed_) return got;
    first_ = 0, last_ = static_cast<std::size_t>(got);
    left_ -= last_;
  }
  const std::size_t count = std::min(size, last_ - first_);
  std::memcpy(to, buffer_.data() + first_, count);
  first_ += count;
  return static_cast<ssize_t>(count);
}

ssize_t Connection::write(const char* from, std::size_t size) {
  return is_writable() ? ::send(socket_, from, size, MSG_NOSIGNAL) : -1;
}

void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip = "127.0.0.1", port = 0;  // nothing else reaches the socket, and nobody asks
}

void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
  get_remote_ip_and_port(ip, port);
}

}  // namespace accdec::explore
