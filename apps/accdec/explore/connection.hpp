#pragma once

#include <array>
#include <chrono>
#include <string>

#include <httplib.h>

namespace accdec::explore {

/// A socket with limits that the library lacks. The head of a request must arrive within a short time, because a thread
/// waits for it before it is known who asks. The whole request has a time limit, too, however slowly it comes. It is
/// read up to a number of bytes in all, however many header lines it has.
class Connection : public httplib::Stream {
 public:
  static constexpr std::chrono::seconds head_time{1}, request_time{5}, write_time{5};
  static constexpr std::size_t head_bytes = 32 << 10, body_bytes = 1 << 20;

  explicit Connection(socket_t socket) : socket_(socket) {}

  /// The limits count from now on, for the next request.
  void begin();
  /// The head is there, and it is the page's own.
  void expect_body();
  /// Whether a limit was passed, or the other end is gone: what is left of the request will not be read.
  bool failed() const { return failed_; }
  /// Whether the other end sends no more: a page that is closed or loaded again reads no answer.
  bool ended() const;
  /// Whether a byte arrives within that time.
  bool wait(std::chrono::milliseconds most) const;

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* to, std::size_t size) override;
  ssize_t write(const char* from, std::size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  bool ready(short event, std::chrono::milliseconds most) const;

  socket_t socket_;
  std::chrono::steady_clock::time_point until_{};
  std::size_t left_ = 0;  ///< bytes that may still be read for this request
  bool failed_ = false;
  std::array<char, 4096> buffer_{};
  std::size_t first_ = 0, last_ = 0;  ///< of the bytes read from the socket and not yet handed on
};

}  // namespace accdec::explore
