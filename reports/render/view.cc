#include "reports/render/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <thread>

#include "reports/render/html.h"
#include "reports/render/page_data.h"
#include "reports/render/replays.h"
#include "reports/render/run_state.h"
#include "reports/render/store.h"
#include "reports/render/view_server.h"

namespace moma::reports {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kTrials = 100000;
constexpr double kReplayHz = 50.0;
constexpr const char* kHost = "127.0.0.1";
constexpr const char* kJson = "application/json; charset=utf-8";

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// What the stores hold, in a few numbers that differ whenever the page's data would.
struct State {
  long long trials = 0;
  long long stored = 0;   ///< of the suite that is being run
  long long planned = 0;  ///< of it; 0 where nothing is
  bool running = false;
  bool killed = false;
  std::string token;
};

/// Adds what the latest run of a store is doing.
void add_run(const std::filesystem::path& db, SQLite::Database& store, State& state) {
  SQLite::Statement latest(store,
                           "SELECT trials_planned, (SELECT count(*) FROM point AS p JOIN point_trial AS m ON "
                           "m.point_id = p.id WHERE p.suite_id = i.suite_id) "
                           "FROM invocation AS i WHERE status = 'running' AND id = (SELECT max(id) FROM invocation)");
  SQLite::Statement search(store,
                           "SELECT 1 FROM tune_search WHERE status = 'running' AND id = (SELECT max(id) FROM "
                           "tune_search)");
  const bool runs = latest.executeStep();
  if (!runs && !search.executeStep()) return;
  const Writer writer = writer_of(db);
  state.killed = state.killed || writer == Writer::kGone;
  if (writer == Writer::kGone) return;
  state.running = true;
  if (!runs) return;
  state.planned += latest.getColumn(0).getInt64();
  state.stored += latest.getColumn(1).getInt64();
}

State state_of(const Stores& stores, std::chrono::milliseconds patience) {
  State state;
  for (const std::filesystem::path& db : stores) {
    SQLite::Database store = open_store(db, patience);
    SQLite::Statement query(
        store,
        "SELECT (SELECT count(*) FROM point_trial), (SELECT count(*) FROM samples), "
        "(SELECT count(*) FROM invocation), (SELECT count(*) FROM invocation WHERE status = "
        "'running'), (SELECT count(*) FROM tune_evaluation), (SELECT count(*) FROM tune_comparison), "
        "(SELECT count(*) FROM tune_search WHERE status = 'running')");
    query.executeStep();
    state.trials += query.getColumn(0).getInt64();
    add_run(db, store, state);
    for (int i = 0; i < query.getColumnCount(); ++i) state.token += fmt::format("{}.", query.getColumn(i).getInt64());
  }
  state.token += state.running ? "r" : state.killed ? "k" : "";
  return state;
}

bool is_trial(const std::string& text) {
  return text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// Answers of one server; safe to be asked by several threads.
class Answers {
 public:
  Answers(const Stores& stores, const ViewOptions& options) : stores_(stores), options_(options) {}

  std::string state() const {
    const State now = state_of(stores_, options_.patience);
    return dumped({{"trials", now.trials},
                   {"running", now.running},
                   {"killed", now.killed},
                   {"stored", now.stored},
                   {"planned", now.planned},
                   {"token", now.token}});
  }

  /// The page's data; read anew only where the store has changed.
  std::shared_ptr<const std::string> data() {
    const std::lock_guard lock(data_mutex_);
    const std::string token = state_of(stores_, options_.patience).token;
    if (data_ == nullptr || token != data_token_) {
      ReportOptions options;
      options.trials = kTrials;
      options.served = true;
      options.time_known = options_.time_known;
      options.look = options_.look;
      options.patience = options_.patience;
      Json page = read_stores(stores_, options);
      page["live"] = {{"token", token}, {"simulates", static_cast<bool>(options_.simulate)}};
      data_ = std::make_shared<const std::string>(dumped(page));
      data_token_ = token;
    }
    return data_;
  }

  /// Nothing where no store has the trial.
  std::optional<std::string> replay(const std::string& trial) {
    for (std::size_t i = 0; i < stores_.size(); ++i) {
      const std::filesystem::path& db = stores_[i];
      SQLite::Database store = open_store(db, options_.patience);
      const auto simulated = [&]() -> std::optional<OwnedSamples> {
        if (!options_.simulate) return {};
        const std::lock_guard lock(simulation_mutex_);
        return options_.simulate(db, trial);
      };
      std::optional<Json> found = replay_of(store, trial, kReplayHz, simulated);
      if (!found) continue;
      // As combined() calls the robots of several stores.
      if (stores_.size() > 1) (*found)["robot"] = fmt::format("{}:{}", i, found->at("robot").get<std::string>());
      return dumped(*found);
    }
    return {};
  }

 private:
  const Stores& stores_;
  const ViewOptions& options_;
  std::mutex data_mutex_;
  std::string data_token_;
  std::shared_ptr<const std::string> data_;
  std::mutex simulation_mutex_;
};

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(dumped({{"error", why}}), kJson);
}

/// In pieces, as it is: the library would compress whole texts for seconds, so that they cross this machine sooner.
void send(httplib::Response& response, std::shared_ptr<const std::string> text, const char* type) {
  response.set_content_provider(
      text->size(), type, [text](std::size_t from, std::size_t size, httplib::DataSink& sink) {
        return sink.write(text->data() + from, std::min<std::size_t>(size, std::size_t{1} << 20));
      });
}

/// Does what `answer` does; what goes wrong becomes an answer too.
template <typename Answer>
auto guarded(Answer answer) {
  return [answer](const httplib::Request& request, httplib::Response& response) {
    try {
      answer(request, response);
    } catch (const std::exception& error) {
      refuse(response, 500, error.what());
    }
  };
}

void add_answers(httplib::Server& server, Answers& answers, const std::shared_ptr<const std::string>& page) {
  server.Get("/", guarded([page](const httplib::Request&, httplib::Response& response) {
               send(response, page, "text/html; charset=utf-8");
             }));
  server.Get("/state.json", guarded([&answers](const httplib::Request&, httplib::Response& response) {
               response.set_content(answers.state(), kJson);
             }));
  server.Get("/data.json", guarded([&answers](const httplib::Request&, httplib::Response& response) {
               send(response, answers.data(), kJson);
             }));
  server.Get(R"(/replay/([^/]*))", guarded([&answers](const httplib::Request& request, httplib::Response& response) {
               const std::string trial = request.matches[1];
               if (!is_trial(trial)) return refuse(response, 400, "not a trial's name; wanted: 16 hex digits");
               const std::optional<std::string> replay = answers.replay(trial);
               if (!replay) return refuse(response, 404, "the store has no such trial");
               send(response, std::make_shared<const std::string>(*replay), kJson);
             }));
}

void add_rules(httplib::Server& server, int port) {
  server.set_pre_routing_handler([port](const httplib::Request& request, httplib::Response& response) {
    // A browser names the site that it believes to talk to: another site's name may resolve to this machine, and its
    // scripts would then read the store.
    const std::string host = request.get_header_value("Host");
    if (host != fmt::format("{}:{}", kHost, port) && host != fmt::format("localhost:{}", port)) {
      refuse(response, 403, fmt::format("wanted: http://{}:{}/", kHost, port));
      return httplib::Server::HandlerResponse::Handled;
    }
    if (request.method != "GET" && request.method != "HEAD") {
      response.set_header("Allow", "GET, HEAD");
      refuse(response, 405, "the stores are only read");
      return httplib::Server::HandlerResponse::Handled;
    }
    return httplib::Server::HandlerResponse::Unhandled;
  });
  server.set_error_handler([](const httplib::Request&, httplib::Response& response) {
    if (response.body.empty()) refuse(response, response.status, "there is nothing here");
  });
}

/// Before the port is bound.
void set_up(httplib::Server& server) {
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"X-Frame-Options", "DENY"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Cross-Origin-Resource-Policy", "same-origin"}});
  server.set_payload_max_length(1024);
  // Not the library's SO_REUSEPORT, by which a second server would silently share the port.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
}

}  // namespace

struct ViewServer::Impl {
  Answers answers;
  std::shared_ptr<const std::string> page;
};

ViewServer::ViewServer(const Stores& stores, const ViewOptions& options) {
  state_of(stores, options.patience);  // says what is wrong with a store before anybody asks for it
  std::string title;
  for (const std::filesystem::path& store : stores) title += (title.empty() ? "" : " + ") + store.filename().string();
  impl_.reset(new Impl{{stores, options}, std::make_shared<const std::string>(served_html(title))});
  set_up(http_);
}

ViewServer::~ViewServer() = default;

void ViewServer::answer_at(int port) {
  add_rules(http_, port);
  add_answers(http_, impl_->answers, impl_->page);
}

void serve(const Stores& stores, const ViewOptions& options, const std::atomic<bool>& stop,
           const std::function<void(const std::string& address)>& ready) {
  if (options.port < 0 || options.port > 65535) throw ReportError("port: wanted: 0 to 65535");
  ViewServer view(stores, options);
  HttpServer& server = view.http();
  int port = options.port;
  const bool bound = port == 0 ? (port = server.bind_to_any_port(kHost)) > 0 : server.bind_to_port(kHost, port);
  if (!bound) {
    throw ReportError(
        fmt::format("port {} of {} cannot be used: another program may have it; wanted: a free one, or 0 "
                    "for any",
                    options.port, kHost));
  }
  server.widen();
  view.answer_at(port);
  std::atomic<bool> ended{false};
  std::thread watch([&] {
    ready(fmt::format("http://{}:{}/", kHost, port));
    while (!stop.load() && !ended.load()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    while (!server.is_running() && !ended.load()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    server.stop();
  });
  const bool clean = server.listen_after_bind();
  ended = true;
  watch.join();
  if (!clean && !stop.load()) throw ReportError(fmt::format("the server at port {} stopped by itself", port));
}

}  // namespace moma::reports
