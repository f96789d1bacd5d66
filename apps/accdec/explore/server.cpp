#include "server.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include <sys/socket.h>

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>

#include "admission.hpp"
#include "computing.hpp"
#include "connection.hpp"

namespace accdec::explore {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t threads = 256, most_pages = 8;
constexpr int most_waiting = 256;  ///< connections that no thread has taken yet
constexpr auto closed_for = 5s;    ///< a page that is loaded again is back sooner

class PageServer : public httplib::Server {
 public:
  explicit PageServer(const Served& served) : served_(served) {
    new_task_queue = [] { return new httplib::ThreadPool(threads); };
    set_payload_max_length(Connection::body_bytes);
    set_default_headers({{"Cache-Control", "no-store"},
                         {"Content-Security-Policy",
                          "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
                          "connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; "
                          "frame-ancestors 'self'"},
                         {"Cross-Origin-Resource-Policy", "same-origin"},
                         {"Referrer-Policy", "no-referrer"},
                         {"X-Content-Type-Options", "nosniff"}});
    // The library refuses these without a text: a body or an address that is too long, an invalid head.
    set_error_handler([](const auto&, auto& response) {
      if (response.body.empty()) refuse(response, {response.status, words(response.status)});
    });
    set_pre_routing_handler([this](const auto& request, auto& response) { return admit(request, response); });
    for (const char* const name : questions) {
      Post("/" + admission_.token() + "/" + name,
           [this, name](const auto& request, auto& response) { compute(name, request, response); });
    }
    int listening = -1;
    set_socket_options([&listening](int socket) { listening = socket; });
    port_ = bind_to_any_port("127.0.0.1");
    if (port_ < 0) throw std::runtime_error("no free port on 127.0.0.1");
    ::listen(listening, most_waiting);  // the library's five are fewer than the files of a page
  }

  std::string address() const { return fmt::format("http://127.0.0.1:{}/{}/", port_, admission_.token()); }

  /// Whether a page was open and none is open now. While all threads are taken a page may wait for one.
  bool left_alone() {
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (pages_ > 0 || connections_ >= threads) last_sign_ = now;
    return seen_ && now - last_sign_ > closed_for;
  }
  void cancel_late() { computing_.cancel_late(); }
  void end() {
    computing_.end();
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    changed_.notify_all();
    stop();
  }

 private:
  using Taken = httplib::Server::HandlerResponse;

  static constexpr std::array<const char*, 7> questions{"design", "view",   "families", "explain",
                                                        "check",  "export", "file"};

  static const char* words(int status) {
    switch (status) {
      case 400: return "not a request of HTTP, or a question without the length of its body";
      case 404: return "no such question";
      case 413: return "the body is longer than the explorer takes: at most 1 MB";
      case 414: return "the address is longer than the explorer takes";
      default: return "refused";
    }
  }
  static Taken refuse(httplib::Response& response, const Refusal& refusal) {
    response.status = refusal.status;
    response.set_content(fmt::format("{{\"error\": \"{}\"}}", refusal.why), "application/json");
    return Taken::Handled;
  }

  /// Before a body is read. GET is answered here, too.
  Taken admit(const httplib::Request& request, httplib::Response& response) {
    if (const auto refused = admission_.refusal(request, port_)) return refuse(response, *refused);
    {
      const std::lock_guard lock(mutex_);
      last_sign_ = std::chrono::steady_clock::now();
    }
    if (request.path.size() == admission_.token().size() + 1) {
      response.set_redirect(request.path + "/");  // its last slash was left out
      return Taken::Handled;
    }
    return request.method == "GET"
               ? fetch(std::string_view(request.path).substr(admission_.token().size() + 2), response)
               : Taken::Unhandled;
  }

  Taken fetch(std::string_view name, httplib::Response& response) {
    if (name == "start") {
      response.set_content(served_.start, "application/json");
      return Taken::Handled;
    }
    if (name == "alive") return watch(response);
    if (name.empty()) name = "index.html";
    for (const PageFile& file : served_.files) {
      if (file.name != name) continue;
      response.set_content(file.text.data(), file.text.size(), std::string(file.type));
      return Taken::Handled;
    }
    if (std::find(questions.begin(), questions.end(), name) != questions.end()) {
      response.set_header("Allow", "POST");
      return refuse(response, {405, "a question is asked by POST"});
    }
    return refuse(response, {404, "no such file"});
  }

  /// An answer that lasts as long as the page: its end is how a closed page is noticed.
  Taken watch(httplib::Response& response) {
    const std::lock_guard lock(mutex_);
    if (pages_ >= most_pages) return refuse(response, {503, "too many pages"});
    ++pages_, seen_ = true;
    response.set_chunked_content_provider(
        "text/event-stream",
        [this](std::size_t, httplib::DataSink& sink) {
          std::unique_lock wait(mutex_);
          if (changed_.wait_for(wait, 500ms, [&] { return over_.load(); })) return false;
          constexpr std::string_view beat = "retry: 500\n\n";  // ms, if the connection ends
          return sink.write(beat.data(), beat.size());
        },
        [this](bool) {
          const std::lock_guard closed(mutex_);
          --pages_, last_sign_ = std::chrono::steady_clock::now();
        });
    return Taken::Handled;
  }

  void compute(const char* name, const httplib::Request& request, httplib::Response& response) {
    const std::optional<double> seconds = seconds_of(request);
    if (!seconds) {
      refuse(response, {400, "`seconds` is no time; allowed is 0 < seconds <= 60"});
      return;
    }
    const std::optional<std::size_t> corner = number_of(request, "corner"), held = number_of(request, "held");
    if (!corner || !held) {
      refuse(response, {400, "`corner` or `held` is no whole number from 0 on"});
      return;
    }
    const std::string slot = request.get_param_value("slot");
    for (std::size_t i = 0; i < request.get_param_value_count("ends"); ++i)
      computing_.cancel(request.get_param_value("client"), request.get_param_value("ends", i));
    const std::string place = fmt::format("{}\n{}\n{}", request.get_param_value("client"), name, slot);
    const bool whole = request.has_param("whole");
    // Other questions keep their time themselves. The question's own clock begins a moment later.
    const Computing::Flag flag =
        computing_.enter(place, whole ? *seconds + 0.1 : std::numeric_limits<double>::infinity(),
                         [asking = asking_] { return asking->ended(); });
    if (!flag) {
      refuse(response, {503, "too many questions at a time"});
      return;
    }
    const std::string format = request.get_param_value("format");
    const Answer given =
        served_.answer({name, request.body, format, *corner, *seconds, whole, place, *held, flag.get()});
    computing_.leave(place, flag);
    response.status = given.status;
    response.set_content(given.text, given.type);
  }

  /// Whether a request comes on an open connection. Who has asked already may take longer for the next one.
  bool comes(const Connection& connection, bool first) {
    const auto until = std::chrono::steady_clock::now() + (first ? Connection::head_time : 5s);
    while (!over_ && std::chrono::steady_clock::now() < until) {
      if (connection.wait(200ms)) return true;
    }
    return false;
  }

  bool process_and_close_socket(socket_t socket) override {
    const int on = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    ++connections_;
    Connection connection(socket);
    asking_ = &connection;
    constexpr int most_requests = 1000;
    bool good = true, closed = false;
    for (int i = 1; good && !closed && i <= most_requests && comes(connection, i == 1); ++i) {
      connection.begin();
      good = process_request(connection, i == most_requests, closed, [&](httplib::Request& request) {
        // Compressing costs more time than the few kilobytes take between two processes.
        request.headers.erase("Accept-Encoding");
        // A refused body is not read; it must not be taken for the next request.
        closed = closed || admission_.refusal(request, port_).has_value();
        if (!closed) connection.expect_body();
      });
      closed = closed || connection.failed();
    }
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    --connections_;
    return good;
  }

  static inline thread_local const Connection* asking_ = nullptr;  ///< whose requests this thread answers

  const Served& served_;
  const Admission admission_;
  int port_ = 0;
  Computing computing_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t pages_ = 0;
  bool seen_ = false;
  std::atomic<bool> over_ = false;
  std::atomic<std::size_t> connections_ = 0;
  std::chrono::steady_clock::time_point last_sign_{};  ///< of a page
};

}  // namespace

extern "C" void accdec_explore_serve(const Served& served, const std::function<void(const std::string& address)>& ready,
                                     const std::atomic<bool>& stop) {
  PageServer server(served);
  std::thread listener([&] { server.listen_after_bind(); });
  while (!server.is_running()) std::this_thread::sleep_for(1ms);
  ready(server.address());
  while (!stop.load() && !server.left_alone() && server.is_running()) {
    std::this_thread::sleep_for(100ms);
    server.cancel_late();
  }
  server.end();
  listener.join();
}

extern "C" const char* accdec_explore_http_version() {
  return CPPHTTPLIB_VERSION;
}

}  // namespace accdec::explore
