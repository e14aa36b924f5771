// What a client may send to `moma view`: the input are the bytes of a connection to the server of a small store, with
// its answers. Addressed to port 8080.
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>

// Before httplib.h, which brings in <resolv.h>: that defines a macro by the name of a parameter of Eigen's.
#include "tests/eval/store_fixture.h"

#include "reports/render/view_server.h"
#include "tests/fuzz/target.h"

namespace {

/// A server, and the store that it shows.
class Server {
 public:
  Server() { view_.answer_at(8080); }
  void converse(int socket) { view_.http().converse(socket); }

 private:
  static std::filesystem::path made(const std::filesystem::path& file) {
    moma::test::write_synthetic(file, {"one"}, 3);
    return file;
  }
  moma::test::TemporaryFolder folder_;
  moma::reports::Stores stores_ = {made(folder_ / "a.db")};
  moma::reports::ViewOptions options_;
  moma::reports::ViewServer view_{stores_, options_};
};

/// All that comes, thrown away but for its beginning.
void drain(int socket, std::array<char, 9>& head, std::size_t& size) {
  std::array<char, 65536> buffer;
  for (;;) {
    const ssize_t got = ::read(socket, buffer.data(), buffer.size());
    if (got <= 0) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(got) && size + i < head.size(); ++i)
      head[size + i] = buffer[i];
    size += static_cast<std::size_t>(got);
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Server server;
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) throw std::runtime_error("no sockets");
  if (size > 0 && ::send(ends[0], data, size, MSG_NOSIGNAL) < 0) throw std::runtime_error("nothing can be sent");
  ::shutdown(ends[0], SHUT_WR);
  std::array<char, 9> head{};
  std::size_t answered = 0;
  std::thread client([&] { drain(ends[0], head, answered); });
  server.converse(ends[1]);
  client.join();
  ::close(ends[0]);
  if (answered > 0 && std::string(head.data(), head.size()) != "HTTP/1.1 ") std::abort();
  return 0;
}
