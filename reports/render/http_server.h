#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <list>
#include <mutex>
#include <thread>

namespace moma::reports {

struct HttpLimits {
  std::size_t threads = 8;                  ///< connections that are answered at once
  std::size_t waiting = 256;                ///< connections that wait for a thread; more are closed
  std::size_t request_bytes = 64 * 1024;    ///< of one request
  std::chrono::milliseconds idle{2000};     ///< from an answer to the next request's first byte
  std::chrono::milliseconds request{5000};  ///< from a request's first byte to its last
  std::chrono::milliseconds answer{60000};  ///< from an answer's first byte to its last
  std::chrono::milliseconds grace{20};      ///< for which a client may say nothing while others wait for a thread
};

/// cpp-httplib's server with bounds that version 0.11 does not have: its time limits are for single reads, so that a
/// client that sends a byte now and then holds a thread for good, and it believes ranges that end behind the content.
/// Here every request and answer has one time limit as a whole, ranges are not offered (RFC 9110, 14.2: a server may
/// ignore them), and where all threads wait for clients, the one that has waited longest is closed for the next
/// connection; while more of them wait for a thread, a client that says nothing for a moment gives way.
class HttpServer final : public httplib::Server {
 public:
  explicit HttpServer(const HttpLimits& limits = {});

  /// After the port is bound: as many connections may wait to be accepted as for a thread. The library lets five wait,
  /// and the sixth one tries again after a second.
  void widen();

  /// Answers the requests of one connection in this thread, and closes it: for one that listen() did not accept.
  void converse(socket_t socket) { (void)process_and_close_socket(socket); }

 private:
  class Connection;
  class Pool;
  friend class Pool;

  bool process_and_close_socket(socket_t socket) override;
  /// Closes the connection that has waited for its client longest, if any waits.
  void close_longest();
  void close_all();
  /// Only closes the socket of a connection that waits for a thread.
  void drop(const std::function<void()>& job);

  HttpLimits limits_;
  std::atomic<std::size_t> queued_{0};  ///< connections that wait for a thread
  std::mutex mutex_;
  std::list<Connection*> connections_;
  bool closing_ = false;
  std::atomic<std::thread::id> dropping_{};  ///< the thread that drops
};

}  // namespace moma::reports
