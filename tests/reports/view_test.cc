// The server of `moma view`, asked over its socket.
#include "reports/render/view.h"

#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>
#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <future>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "tests/reports/store_files.h"

namespace moma::reports {
namespace {

using nlohmann::json;

/// What a server answers to these very bytes.
std::string raw(int port, const std::string& request, bool then_closes = false) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) return "no connection";
  const timeval patience{60, 0};  // an hour later is no answer
  setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  if (send(socket, request.data(), request.size(), MSG_NOSIGNAL) < 0) return "not sent";
  if (then_closes) shutdown(socket, SHUT_WR);
  std::string answer;
  char part[4096];
  for (ssize_t n = 0; (n = recv(socket, part, sizeof part, 0)) > 0;) answer.append(part, static_cast<std::size_t>(n));
  close(socket);
  return answer;
}

std::string request(int port, const std::string& path) {
  return raw(port,
             "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\nConnection: close\r\n\r\n");
}

struct Response {
  int status = 0;
  std::string head;
  std::string body;
};

struct Client {
  int port = 0;
  std::optional<Response> Get(const std::string& path) const {
    const std::string answer = request(port, path);
    const std::size_t end = answer.find("\r\n\r\n");
    if (!answer.starts_with("HTTP/1.1 ") || end == std::string::npos) return {};
    return Response{std::stoi(answer.substr(9, 3)), answer.substr(0, end), answer.substr(end + 4)};
  }
};

/// A server while it lives; its destructor ends it as Ctrl-C does.
class Running {
 public:
  explicit Running(const Stores& stores, ViewOptions options = {}) {
    options.port = 0;
    std::promise<std::string> ready;
    thread_ = std::thread([this, stores, options, &ready] {
      serve(stores, options, stop_, [&ready](const std::string& address) { ready.set_value(address); });
    });
    address_ = ready.get_future().get();
    port_ = std::stoi(address_.substr(address_.rfind(':') + 1));
  }
  ~Running() {
    stop_ = true;
    thread_.join();
  }
  Client client() const { return {port_}; }
  int port() const { return port_; }
  const std::string& address() const { return address_; }

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
  std::string address_;
  int port_ = 0;
};

std::string a_trial(const std::filesystem::path& db, const std::string& with) {
  return SQLite::Database(db.string())
      .execAndGet("SELECT trial FROM trial WHERE key " + with + " (SELECT key FROM samples) ORDER BY trial LIMIT 1")
      .getString();
}

TEST(View, ServesThePageItsDataAndAMotion) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 20);
  const Running server({folder / "a.db"});
  const Client client = server.client();
  EXPECT_EQ(server.address(), "http://127.0.0.1:" + std::to_string(server.port()) + "/");

  const auto page = client.Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_NE(page->body.find("connect-src 'self'"), std::string::npos);
  EXPECT_EQ(data_of(page->body), json::object());
  EXPECT_NE(page->head.find("\r\nX-Content-Type-Options: nosniff\r\n"), std::string::npos) << page->head;
  EXPECT_EQ(page->head.find("Access-Control-Allow-Origin"), std::string::npos) << page->head;

  // As it is: compressing it took seconds.
  for (const char* path : {"/", "/data.json"}) {
    const std::string head = raw(server.port(), std::string("GET ") + path +
                                                    " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) +
                                                    "\r\nAccept-Encoding: br, gzip\r\nConnection: close\r\n\r\n");
    EXPECT_EQ(head.substr(0, head.find("\r\n\r\n")).find("Content-Encoding"), std::string::npos) << path;
  }

  // The same numbers as the written page.
  const auto answer = client.Get("/data.json");
  ASSERT_TRUE(answer);
  const json data = json::parse(answer->body);
  const json written = page_of({folder / "a.db"});
  for (const char* part : {"trials", "summary", "overall", "points", "invocations", "tuning"}) {
    EXPECT_EQ(data.at(part), written.at(part)) << part;
  }
  EXPECT_FALSE(data.at("live").at("simulates").get<bool>());
  ASSERT_EQ(data.at("replays").size(), written.at("replays").size());
  EXPECT_FALSE(data.at("replays").at(0).contains("data"));

  const std::string trial = a_trial(folder / "a.db", "IN");
  const auto motion = client.Get("/replay/" + trial);
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->status, 200);
  const json replay = json::parse(motion->body);
  EXPECT_EQ(replay.at("trial"), trial);
  EXPECT_FALSE(replay.at("simulated").get<bool>());
  EXPECT_TRUE(replay.at("resolved").contains("urdf_text"));
  // Every sample, not only ten a second.
  const int stored = SQLite::Database((folder / "a.db").string())
                         .execAndGet("SELECT n FROM samples JOIN trial USING (key) WHERE trial = '" + trial + "'")
                         .getInt();
  EXPECT_EQ(replay.at("n"), stored);

  const std::string bare = a_trial(folder / "a.db", "NOT IN");
  EXPECT_EQ(json::parse(client.Get("/replay/" + bare)->body).at("n"), 0);
  EXPECT_EQ(client.Get("/replay/0123456789abcdef")->status, 404);
}

TEST(View, AskedForATrialWithoutSamplesItHasItSimulated) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 20);
  ViewOptions options;
  std::atomic<int> calls{0};
  options.simulate = [&](const std::filesystem::path& store, const std::string& trial) -> std::optional<OwnedSamples> {
    ++calls;
    EXPECT_EQ(store, folder / "a.db");
    if (calls > 1) throw CannotSimulate("no such robot any more: " + trial);
    SQLite::Database db(store.string());
    SQLite::Statement any(db, "SELECT layout, n, columns, data FROM samples LIMIT 1");
    any.executeStep();
    const auto* bytes = static_cast<const unsigned char*>(any.getColumn(3).getBlob());
    return OwnedSamples{any.getColumn(0).getInt(),
                        any.getColumn(1).getInt64(),
                        json::parse(any.getColumn(2).getString()).get<std::vector<std::string>>(),
                        {bytes, bytes + any.getColumn(3).getBytes()},
                        {{"hand", "sphere3"},
                         {{0.0, DistanceRows::Kind::kObject, 0, 1, true, 0.25, {0.5, -1, 2}, {0.75, 0, 40}},
                          {0.0, DistanceRows::Kind::kFloor, 0, 1, false, -0.01, {}, {}},
                          {1e6, DistanceRows::Kind::kObject, 0, 1, true, 0.25, {}, {}}}}};
  };
  const Running server({folder / "a.db"}, options);
  const Client client = server.client();
  EXPECT_TRUE(json::parse(client.Get("/data.json")->body).at("live").at("simulates").get<bool>());
  const std::string bare = a_trial(folder / "a.db", "NOT IN");
  const json replay = json::parse(client.Get("/replay/" + bare)->body);
  EXPECT_TRUE(replay.at("simulated").get<bool>());
  EXPECT_EQ(replay.at("trial"), bare);
  EXPECT_GT(replay.at("n").get<int>(), 1);
  // The rows of the first sample; of what no sample is at there are none.
  const json& rows = replay.at("rows");
  EXPECT_EQ(rows.at("names"), json({"hand", "sphere3"}));
  ASSERT_EQ(rows.at("n").size(), replay.at("n").get<std::size_t>());
  EXPECT_EQ(rows.at("n").at(0), 2);
  for (std::size_t i = 1; i < rows.at("n").size(); ++i) EXPECT_EQ(rows.at("n").at(i), 0);
  const auto failed = client.Get("/replay/" + bare);
  EXPECT_EQ(failed->status, 500);
  EXPECT_EQ(json::parse(failed->body).at("error"), "no such robot any more: " + bare);
  // Stored samples are shown without their rows where the trial cannot be simulated again.
  const auto stored = client.Get("/replay/" + a_trial(folder / "a.db", "IN"));
  EXPECT_EQ(stored->status, 200);
  EXPECT_FALSE(json::parse(stored->body).contains("rows"));
  EXPECT_EQ(calls, 3);
}

TEST(View, FollowsARunningStoreAndOnlyReads) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 10);
  const Running server({folder / "a.db"});
  const Client client = server.client();
  const json before = json::parse(client.Get("/state.json")->body);
  EXPECT_EQ(before.at("trials"), 20);
  EXPECT_FALSE(before.at("running").get<bool>());
  EXPECT_EQ(json::parse(client.Get("/data.json")->body).at("live").at("token"), before.at("token"));

  SQLite::Database writer((folder / "a.db").string(), SQLite::OPEN_READWRITE);
  {
    SQLite::Transaction pending(writer);  // not yet to be seen
    writer.exec("UPDATE invocation SET status = 'running', ended = NULL");
    writer.exec("DELETE FROM point_trial WHERE world_index = 9");
    EXPECT_EQ(json::parse(client.Get("/state.json")->body), before);
    pending.commit();
  }
  const json after = json::parse(client.Get("/state.json")->body);
  EXPECT_EQ(after.at("trials"), 18);
  EXPECT_TRUE(after.at("running").get<bool>());
  const json data = json::parse(client.Get("/data.json")->body);
  EXPECT_EQ(data.at("trials").at("n"), 18);
  EXPECT_EQ(data.at("live").at("token"), after.at("token"));

  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "OPTIONS"}) {
    const std::string answer =
        raw(server.port(), std::string(method) + " / HTTP/1.1\r\nHost: localhost:" + std::to_string(server.port()) +
                               "\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
    EXPECT_EQ(answer.rfind("HTTP/1.1 405", 0), 0u) << method << ": " << answer.substr(0, 40);
  }
}

TEST(View, RefusesOtherNamesOfThisMachine) {
  const Folder folder;
  make_store(folder / "a.db", "empty", 0);
  const Running server({folder / "a.db"});
  const std::string port = std::to_string(server.port());
  const auto status = [&](const std::string& host) {
    const std::string answer = raw(server.port(), "GET /data.json HTTP/1.1\r\n" + host + "Connection: close\r\n\r\n");
    return answer.substr(0, answer.find("\r\n")).substr(std::string("HTTP/1.1 ").size(), 3);
  };
  EXPECT_EQ(status("Host: 127.0.0.1:" + port + "\r\n"), "200");
  EXPECT_EQ(status("Host: localhost:" + port + "\r\n"), "200");
  for (const std::string& host :
       {std::string(""), std::string("Host: evil.example\r\n"), "Host: evil.example:" + port + "\r\n",
        std::string("Host: 127.0.0.1\r\n"), "Host: 127.0.0.1:" + port + ".evil.example\r\n",
        "Host: 127.0.0.1:1" + port + "\r\n", "Host: 127.0.0.1.evil.example:" + port + "\r\n"}) {
    EXPECT_EQ(status(host), "403") << host;
  }
}

TEST(View, NoRequestReachesAFile) {
  const Folder folder;
  make_store(folder / "a.db", "empty", 0);
  const Running server({folder / "a.db"});
  for (const char* path :
       {"/a.db", "/../a.db", "/..%2fa.db", "/%2e%2e/%2e%2e/etc/passwd", "/../../../../etc/passwd", "//etc/passwd",
        "/replay/../../etc/passwd", "/replay/%2e%2e%2f%2e%2e%2fetc%2fpasswd", "/replay/a.db", "/replay/",
        "/replay/' OR 1=1 --", "/replay/0123456789ABCDEF", "/replay/0123456789abcde%00"}) {
    const std::string answer = request(server.port(), path);
    EXPECT_TRUE(answer.rfind("HTTP/1.1 404", 0) == 0 || answer.rfind("HTTP/1.1 400", 0) == 0)
        << path << ": " << answer.substr(0, 60);
    EXPECT_EQ(answer.find("root:"), std::string::npos) << path;
    EXPECT_EQ(answer.find("SQLite format"), std::string::npos) << path;
  }
}

TEST(View, SaysWhatIsWrongBeforeItServes) {
  const Folder folder;
  const auto message = [](const Stores& stores, int port) -> std::string {
    const std::atomic<bool> stop{true};
    ViewOptions options;
    options.port = port;
    try {
      serve(stores, options, stop, [](const std::string&) {});
    } catch (const ReportError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message({folder / "none.db"}, 0).find("there is no such file"), std::string::npos);
  make_store(folder / "a.db", "empty", 0);
  EXPECT_NE(message({folder / "a.db"}, 70000).find("wanted: 0 to 65535"), std::string::npos);
  EXPECT_EQ(message({folder / "a.db"}, 0), "");
  const Running server({folder / "a.db"});
  const std::string taken = message({folder / "a.db"}, server.port());
  EXPECT_NE(taken.find("another program may have it"), std::string::npos) << taken;
}

TEST(View, AStoreThatVanishesIsAnAnswer) {
  const Folder folder;
  make_store(folder / "a.db", "empty", 0);
  const Running server({folder / "a.db"});
  const Client client = server.client();
  EXPECT_EQ(client.Get("/state.json")->status, 200);
  std::filesystem::remove(folder / "a.db");
  const auto gone = client.Get("/state.json");
  EXPECT_EQ(gone->status, 500);
  EXPECT_NE(gone->body.find("there is no such file"), std::string::npos);
}

TEST(View, LeavesNothingBesideTheStore) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 4);
  {
    const Running server({folder / "a.db"});
    const Client client = server.client();
    EXPECT_EQ(client.Get("/data.json")->status, 200);
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().filename(), "a.db");
}

/// Connections that ask for something and never end, or read nothing.
class Holding {
 public:
  Holding(int port, std::size_t count, const std::string& begin) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (std::size_t i = 0; i < count; ++i) {
      const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
      const int little = 1024;
      setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &little, sizeof little);
      if (connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0)
        (void)send(socket, begin.data(), begin.size(), MSG_NOSIGNAL);
      sockets_.push_back(socket);
    }
  }
  ~Holding() {
    for (const int socket : sockets_) close(socket);
  }

 private:
  std::vector<int> sockets_;
};

TEST(View, RangesAreIgnoredAndNothingBehindTheContentIsSent) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 3);
  const Running server({folder / "a.db"});
  for (const char* path : {"/state.json", "/data.json", "/", "/nothing"}) {
    const std::string whole = request(server.port(), path);
    for (const char* range : {"0-99999999999", "999999999999-9999999999999", "5-9", "-5", "0-0,7-99999999", "9-2",
                              "0-9223372036854775807"}) {
      const std::string answer = raw(
          server.port(), std::string("GET ") + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) +
                             "\r\nRange: bytes=" + range + "\r\nConnection: close\r\n\r\n");
      if (answer.find(" 416 ") != std::string::npos) continue;  // not even a range
      EXPECT_EQ(answer, whole) << path << " " << range;
    }
  }
}

TEST(View, ClientsThatHoldItDoNotKeepOthersOut) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 3);
  const Running server({folder / "a.db"});
  const int port = server.port();
  const std::string host = "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
  // Half a request each, or nothing at all, or an answer that nobody reads: all at once, many more than there are
  // threads.
  for (const std::string& begin :
       {"GET / HTTP/1.1\r\n" + host + "X: ", std::string(), "GET / HTTP/1.1\r\n" + host + "\r\n"}) {
    for (const std::size_t count : {16U, 100U, 300U}) {
      const Holding holding(port, count, begin);
      for (int i = 0; i < 3; ++i)
        EXPECT_NE(request(port, "/state.json").find(" 200 "), std::string::npos) << count << " of " << begin;
    }
  }
}

TEST(View, WhateverIsSentGetsAnAnswerOfHttpOrNone) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 3);
  const Running server({folder / "a.db"});
  // All at once: the server waits for the rest of each that is cut short.
  std::vector<std::pair<std::string, std::future<std::string>>> sent;
  for (const auto& entry : std::filesystem::directory_iterator(MOMA_SOURCE_DIR "/tests/data/fuzz/http")) {
    std::string bytes = read_file(entry.path());
    const std::string port = std::to_string(server.port());
    for (std::size_t at = bytes.find("8080"); at != std::string::npos; at = bytes.find("8080", at + port.size()))
      bytes.replace(at, 4, port);
    // Cut short, it is a client that gives up.
    for (const std::size_t size : {bytes.size(), bytes.size() / 2}) {
      sent.emplace_back(entry.path(), std::async(std::launch::async, raw, server.port(), bytes.substr(0, size), true));
    }
  }
  EXPECT_GE(sent.size(), 20u);
  for (auto& [file, future] : sent) {
    const std::string answer = future.get();
    EXPECT_TRUE(answer.empty() || answer.starts_with("HTTP/1.1 ")) << file << ": " << answer.substr(0, 40);
  }
  EXPECT_NE(request(server.port(), "/state.json").find(" 200 "), std::string::npos);
}

TEST(View, ARequestHasABoundedLength) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 3);
  const Running server({folder / "a.db"});
  for (const std::string& begin :
       {std::string(), "GET / HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) + "\r\n"}) {
    std::string endless = begin;
    for (int i = 0; i < 20000; ++i) endless += begin.empty() ? "GGGGGGGGGG" : "X: aaaa\r\n";
    EXPECT_EQ(raw(server.port(), endless).find(" 200 "), std::string::npos);
  }
  EXPECT_NE(request(server.port(), "/state.json").find(" 200 "), std::string::npos);
}

TEST(View, AStoreWithoutEndIsGivenUp) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 3);
  change(folder / "a.db",
         "DROP VIEW v_summary; CREATE VIEW v_summary AS WITH RECURSIVE c (x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM "
         "c) SELECT x AS suite, x AS robot, x AS controller, x AS point, x AS family, x AS mode, x AS n FROM c");
  ReportOptions options;
  options.patience = std::chrono::milliseconds(300);
  try {
    write_report({folder / "a.db"}, folder / "a.html", options);
    ADD_FAILURE() << "it has an end";
  } catch (const ReportError& error) {
    EXPECT_NE(std::string(error.what()).find("not been read after 0.3 s"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "a.html"));
  ViewOptions view;
  view.patience = options.patience;
  const Running server({folder / "a.db"}, view);
  EXPECT_NE(request(server.port(), "/data.json").find("HTTP/1.1 500"), std::string::npos);
  EXPECT_NE(request(server.port(), "/state.json").find("HTTP/1.1 200"), std::string::npos);
}

}  // namespace
}  // namespace moma::reports
