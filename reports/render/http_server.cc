#include "reports/render/http_server.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <optional>
#include <thread>
#include <vector>

namespace moma::reports {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

/// One client; the library reads and writes through it.
class HttpServer::Connection final : public httplib::Stream {
 public:
  Connection(socket_t socket, const HttpLimits& limits, const std::atomic<std::size_t>& queued)
      : socket_(socket), limits_(limits), queued_(queued) {}

  /// A new request begins; what was read of it already counts. `idle`: for how long the client may say nothing.
  void begin(std::chrono::milliseconds idle) {
    deadline_ = Clock::now() + (size_ > at_ ? limits_.request : idle);
    begun_ = size_ > at_;
    answering_ = false;
    bytes_ = 0;
  }

  /// Wakes the thread that serves it: nothing can be read or written any more.
  void close() {
    closed_ = true;
    ::shutdown(socket_, SHUT_RDWR);
  }
  bool closed() const { return closed_; }

  /// Since when its client lets us wait.
  std::optional<Clock::time_point> waiting() const {
    const Clock::rep since = waiting_.load();
    if (since == 0) return {};
    return Clock::time_point(Clock::duration(since));
  }

  bool is_readable() const override { return at_ < size_ || wait(POLLIN); }
  bool is_writable() const override { return wait(POLLOUT); }

  ssize_t read(char* to, std::size_t size) override {
    if (bytes_ >= limits_.request_bytes) return -1;
    if (at_ == size_) {
      if (!wait(POLLIN)) return -1;
      ssize_t got = 0;
      do got = ::recv(socket_, buffer_, sizeof buffer_, 0);
      while (got < 0 && errno == EINTR);
      if (got <= 0) return got;
      at_ = 0;
      size_ = static_cast<std::size_t>(got);
      if (!begun_) deadline_ = Clock::now() + limits_.request;
      begun_ = true;
    }
    const std::size_t n = std::min({size, size_ - at_, limits_.request_bytes - bytes_});
    std::copy_n(buffer_ + at_, n, to);
    at_ += n;
    bytes_ += n;
    return static_cast<ssize_t>(n);
  }

  ssize_t write(const char* from, std::size_t size) override {
    if (!answering_) deadline_ = Clock::now() + limits_.answer;
    answering_ = true;
    if (!wait(POLLOUT)) return -1;
    ssize_t sent = 0;
    do sent = ::send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    while (sent < 0 && errno == EINTR);
    return sent < 0 && errno == EAGAIN ? 0 : sent;
  }

  void get_remote_ip_and_port(std::string& ip, int& port) const override { nobody(ip, port); }
  void get_local_ip_and_port(std::string& ip, int& port) const override { nobody(ip, port); }
  socket_t socket() const override { return socket_; }

 private:
  static void nobody(std::string& ip, int& port) {
    ip.clear();
    port = 0;
  }

  /// Until the client is ready; false where the time is over, or others wait for this thread.
  bool wait(short event) const {
    const Clock::time_point since = Clock::now();
    waiting_.store(since.time_since_epoch().count());
    bool ready = false;
    while (!ready) {
      const auto end = queued_.load() > 0 ? std::min(deadline_, since + limits_.grace) : deadline_;
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
      if (left < 0) break;
      pollfd one{socket_, event, 0};
      const int found = ::poll(&one, 1, static_cast<int>(left) + 1);
      if (found < 0 && errno != EINTR) break;
      ready = found > 0;
    }
    waiting_.store(0);
    return ready;
  }

  socket_t socket_;
  const HttpLimits& limits_;
  const std::atomic<std::size_t>& queued_;
  bool closed_ = false;  ///< under the server's mutex
  Clock::time_point deadline_;
  bool begun_ = false;
  bool answering_ = false;
  std::size_t bytes_ = 0;  ///< of this request
  char buffer_[4096];
  std::size_t at_ = 0;
  std::size_t size_ = 0;
  mutable std::atomic<Clock::rep> waiting_{0};  ///< 0: does not
};

class HttpServer::Pool final : public httplib::TaskQueue {
 public:
  explicit Pool(HttpServer& server) : server_(server) {
    for (std::size_t i = 0; i < server.limits_.threads; ++i) threads_.emplace_back([this] { work(); });
  }

  void enqueue(std::function<void()> job) override {
    std::function<void()> dropped;
    bool busy = false;
    {
      const std::lock_guard lock(mutex_);
      jobs_.push_back(std::move(job));
      busy = jobs_.size() > idle_;
      if (jobs_.size() > server_.limits_.waiting) {
        dropped = std::move(jobs_.front());
        jobs_.pop_front();
      }
      server_.queued_ = jobs_.size();
    }
    more_.notify_one();
    if (busy) server_.close_longest();
    if (dropped) server_.drop(dropped);
  }

  void shutdown() override {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    server_.close_all();
    more_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  void work() {
    for (;;) {
      std::function<void()> job;
      {
        std::unique_lock lock(mutex_);
        ++idle_;
        more_.wait(lock, [this] { return ended_ || !jobs_.empty(); });
        --idle_;
        if (jobs_.empty()) return;
        job = std::move(jobs_.front());
        jobs_.pop_front();
        server_.queued_ = jobs_.size();
      }
      job();
    }
  }

  HttpServer& server_;
  std::mutex mutex_;
  std::condition_variable more_;
  std::deque<std::function<void()>> jobs_;
  std::size_t idle_ = 0;
  bool ended_ = false;
  std::vector<std::thread> threads_;
};

HttpServer::HttpServer(const HttpLimits& limits) : limits_(limits) {
  new_task_queue = [this] { return new Pool(*this); };  // the library deletes it
}

void HttpServer::widen() { (void)::listen(svr_sock_, static_cast<int>(limits_.waiting)); }

bool HttpServer::process_and_close_socket(socket_t socket) {
  Connection connection(socket, limits_, queued_);
  std::list<Connection*>::iterator place;
  bool serve = false;
  {
    const std::lock_guard lock(mutex_);
    serve = !closing_ && dropping_.load() != std::this_thread::get_id();
    place = connections_.insert(connections_.end(), &connection);
  }
  bool answered = false;
  for (std::size_t left = keep_alive_max_count_; serve && left > 0; --left) {
    connection.begin(answered ? limits_.idle : limits_.request);
    bool last = false;
    answered = process_request(connection, left == 1, last, [](httplib::Request& request) { request.ranges.clear(); });
    serve = answered && !last;
  }
  {
    const std::lock_guard lock(mutex_);
    connections_.erase(place);
  }
  ::shutdown(socket, SHUT_RDWR);
  ::close(socket);
  return answered;
}

void HttpServer::close_longest() {
  const std::lock_guard lock(mutex_);
  Connection* longest = nullptr;
  std::optional<Clock::time_point> since;
  for (Connection* connection : connections_) {
    const auto waiting = connection->waiting();
    if (!waiting || connection->closed() || (since && *waiting >= *since)) continue;
    longest = connection;
    since = waiting;
  }
  if (longest != nullptr) longest->close();
}

void HttpServer::drop(const std::function<void()>& job) {
  dropping_ = std::this_thread::get_id();
  job();
  dropping_ = std::thread::id();
}

void HttpServer::close_all() {
  const std::lock_guard lock(mutex_);
  closing_ = true;
  for (Connection* connection : connections_) connection->close();
}

}  // namespace moma::reports
