#include "reports/render/view.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <microhttpd.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <thread>

#include "reports/render/html.h"
#include "reports/render/page_data.h"
#include "reports/render/store.h"

namespace moma::reports {
namespace {

using Text = std::shared_ptr<const std::string>;

constexpr std::int64_t kTrials = 100000;
constexpr double kReplayHz = 50.0;
constexpr const char* kHost = "127.0.0.1";
constexpr const char* kJson = "application/json; charset=utf-8";
constexpr const char* kHtml = "text/html; charset=utf-8";
/// Threads that answer. None waits for a client: each serves its connections as they become ready.
constexpr unsigned kThreads = 8;
constexpr unsigned kConnections = 500;            ///< at once; more wait to be accepted
constexpr std::size_t kRequestBytes = 64 * 1024;  ///< of one request's head
constexpr unsigned kIdleSeconds = 5;              ///< for which a client may send nothing
constexpr unsigned kSendSeconds = 60;             ///< for which it may take nothing of its answer
constexpr std::pair<const char*, const char*> kHeaders[] = {
    {"Cache-Control", "no-store"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Connection", "close"}};  // so that the next request goes to a thread that has time

/// State of the stores in a few numbers, which differ whenever the page's data would.
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
  Text data() {
    const std::lock_guard lock(data_mutex_);
    const std::string token = state_of(stores_, options_.patience).token;
    if (data_ == nullptr || token != data_token_) {
      ReportOptions options = options_;
      options.trials = kTrials;
      options.served = true;
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
      Simulate simulate;
      if (options_.simulate) {
        simulate = [&](const std::filesystem::path& file, const std::string& name) {
          const std::lock_guard lock(simulation_mutex_);
          return options_.simulate(file, name);
        };
      }
      std::optional<Json> found = replay_of(store, trial, kReplayHz, simulate);
      if (!found) continue;
      // combined() names the robots of several stores so.
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
  Text data_;
  std::mutex simulation_mutex_;
};

struct Answer {
  unsigned status = MHD_HTTP_OK;
  Text text;
  const char* type = kJson;
};

Answer text_of(std::string text) { return {MHD_HTTP_OK, std::make_shared<const std::string>(std::move(text))}; }

Answer refusal(unsigned status, const std::string& why) {
  return {status, std::make_shared<const std::string>(dumped({{"error", why}}))};
}

struct Server {
  Answers answers;
  Text page;
  std::atomic<int> port{0};

  Answer answer(const std::string& path, const std::string& method, const std::string& host) {
    // Guard against DNS rebinding: a foreign host name may resolve to this machine, and its scripts would then read
    // the store. The browser names the host that it believes to talk to.
    if (host != fmt::format("{}:{}", kHost, port.load()) && host != fmt::format("localhost:{}", port.load()))
      return refusal(MHD_HTTP_FORBIDDEN, fmt::format("wanted: http://{}:{}/", kHost, port.load()));
    if (method != MHD_HTTP_METHOD_GET && method != MHD_HTTP_METHOD_HEAD)
      return refusal(MHD_HTTP_METHOD_NOT_ALLOWED, "the stores are only read");
    if (path == "/") return {MHD_HTTP_OK, page, kHtml};
    if (path == "/state.json") return text_of(answers.state());
    if (path == "/data.json") return {MHD_HTTP_OK, answers.data()};
    constexpr std::string_view kReplay = "/replay/";
    if (!path.starts_with(kReplay)) return refusal(MHD_HTTP_NOT_FOUND, "there is nothing here");
    const std::string trial = path.substr(kReplay.size());
    if (!is_trial(trial)) return refusal(MHD_HTTP_BAD_REQUEST, "not a trial's name; wanted: 16 hex digits");
    std::optional<std::string> replay = answers.replay(trial);
    return replay ? text_of(std::move(*replay)) : refusal(MHD_HTTP_NOT_FOUND, "the store has no such trial");
  }
};

MHD_Result send(MHD_Connection* connection, const Answer& answer) {
  auto kept = std::make_unique<Text>(answer.text);
  MHD_Response* response = MHD_create_response_from_buffer_with_free_callback_cls(
      (*kept)->size(), const_cast<char*>((*kept)->data()), [](void* text) { delete static_cast<Text*>(text); },
      kept.get());
  if (response == nullptr) return MHD_NO;
  (void)kept.release();  // the response's own
  MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, answer.type);
  if (answer.status == MHD_HTTP_METHOD_NOT_ALLOWED) MHD_add_response_header(response, "Allow", "GET, HEAD");
  for (const auto& [name, value] : kHeaders) MHD_add_response_header(response, name, value);
  const MHD_Result queued = MHD_queue_response(connection, answer.status, response);
  MHD_destroy_response(response);
  return queued;
}

MHD_Result on_request(void* server, MHD_Connection* connection, const char* path, const char* method,
                      const char* /*version*/, const char* /*body*/, std::size_t* /*body_size*/, void** /*request*/) {
  const char* host = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_HOST);
  Answer answer;
  try {
    answer = static_cast<Server*>(server)->answer(path, method, host == nullptr ? "" : host);
  } catch (const std::exception& error) {
    answer = refusal(MHD_HTTP_INTERNAL_SERVER_ERROR, error.what());
  }
  // The time that the answer took is not the client's: its clock starts anew where it did not run.
  MHD_set_connection_option(connection, MHD_CONNECTION_OPTION_TIMEOUT, 0U);
  MHD_set_connection_option(connection, MHD_CONNECTION_OPTION_TIMEOUT, kSendSeconds);
  return send(connection, answer);
}

struct Stop {
  void operator()(MHD_Daemon* daemon) const { MHD_stop_daemon(daemon); }
};

}  // namespace

void serve(const Stores& stores, const ViewOptions& options, const std::atomic<bool>& stop,
           const std::function<void(const std::string& address)>& ready) {
  if (options.port < 0 || options.port > 65535) throw ReportError("port: wanted: 0 to 65535");
  state_of(stores, options.patience);  // says what is wrong with a store before anybody asks for it
  std::string title;
  for (const std::filesystem::path& store : stores) title += (title.empty() ? "" : " + ") + store.filename().string();
  Server server{{stores, options}, std::make_shared<const std::string>(served_html(title))};
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(options.port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  // Without the date: ranges and repeated requests get the same bytes.
  const std::unique_ptr<MHD_Daemon, Stop> daemon(MHD_start_daemon(
      MHD_USE_AUTO_INTERNAL_THREAD | MHD_USE_SUPPRESS_DATE_NO_CLOCK, 0, nullptr, nullptr, &on_request, &server,
      MHD_OPTION_SOCK_ADDR, &address, MHD_OPTION_THREAD_POOL_SIZE, kThreads, MHD_OPTION_CONNECTION_LIMIT, kConnections,
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, kRequestBytes, MHD_OPTION_CONNECTION_TIMEOUT, kIdleSeconds, MHD_OPTION_END));
  if (daemon == nullptr) {
    throw ReportError(
        fmt::format("port {} of {} cannot be used: another program may have it; wanted: a free one, or 0 "
                    "for any",
                    options.port, kHost));
  }
  server.port = MHD_get_daemon_info(daemon.get(), MHD_DAEMON_INFO_BIND_PORT)->port;
  ready(fmt::format("http://{}:{}/", kHost, server.port.load()));
  while (!stop.load()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace moma::reports
