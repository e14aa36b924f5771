#pragma once

#include <memory>

#include "reports/render/http_server.h"
#include "reports/render/view.h"

namespace moma::reports {

/// The server that serve() runs, with its answers: apart from what it listens at, so that it can be tested by the bytes
/// of a connection.
class ViewServer {
 public:
  /// Both have to outlive it. Throws ReportError where a store cannot be read.
  ViewServer(const Stores& stores, const ViewOptions& options);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  HttpServer& http() noexcept { return http_; }
  /// Once, after the port is bound: requests have to be addressed to it.
  void answer_at(int port);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  HttpServer http_;
};

}  // namespace moma::reports
