#include "plugin/process/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <string_view>

#include "controller/config/json_node.h"
#include "plugin/border.h"
#include "plugin/host/library.h"
#include "plugin/host/plugin.h"

namespace moma {
namespace {

using Clock = Child::Clock;

Clock::time_point in_seconds(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(seconds, 1e8)));
}

std::string after(const char* link, const std::string& words) { return words.empty() ? words : link + words; }

// Time until a process that ended its output, or was released, is killed.
constexpr double kGrace = 2.0;

std::string text_of(std::span<const unsigned char> bytes) { return without_controls({bytes.begin(), bytes.end()}); }

}  // namespace

Session::Session(const ProcessCommand& command) : limits_(command.limits), child_(command), in_(std::size_t{1} << 16) {}

Session::~Session() {
  child_.hang_up();
  child_.end(broken_ ? Clock::now() : in_seconds(kGrace));
}

void Session::fail(const std::string& what) {
  broken_ = true;
  throw PluginError(what);
}

Session::Due Session::due(const char* to, double seconds) { return {to, seconds, in_seconds(seconds)}; }

void Session::ended(const Due& due) {
  const bool killed = child_.end(in_seconds(kGrace));
  const std::string how = killed ? "closed its standard output" : child_.ending();
  fail(fmt::format("its process {}; an answer {} was due{}", how, due.to, after("; it said: ", child_.last_words())));
}

void Session::late(const Due& due) {
  fail(fmt::format("{}{} within {:g}{}{}", kLateBefore, due.to, due.seconds, kLateAfter,
                   after("; it said: ", child_.last_words())));
}

// Shortens the input to the part that does not depend on how slowly it arrives, so that messages are the same each
// time.
void Session::not_a_frame() {
  fail(fmt::format("its process writes to its standard output what is no frame of the protocol, beginning with '{}'",
                   text_of(std::span(in_).first(kFrameHeader))));
}

std::span<const unsigned char> Session::answer(Frame wanted, const Due& due) {
  std::size_t have = 0;
  for (;;) {
    std::size_t got = 0;
    const Child::Wait wait = child_.receive(std::span(in_).subspan(have), got, due.until);
    if (wait == Child::Wait::kLate) late(due);
    if (wait == Child::Wait::kEnded) ended(due);
    have += got;
    if (have < kFrameHeader) continue;
    std::uint32_t header[2];
    std::memcpy(header, in_.data(), sizeof header);
    const auto [length, kind] = header;
    const bool known =
        kind >= static_cast<std::uint32_t>(Frame::kReady) && kind <= static_cast<std::uint32_t>(Frame::kError);
    const std::size_t size = kFrameHeader + length;
    if (!known || length > kLargestAnswer) not_a_frame();
    if (in_.size() < size) in_.resize(size);
    if (have < size) continue;
    const std::span<const unsigned char> payload = std::span(in_).subspan(kFrameHeader, length);
    if (kind == static_cast<std::uint32_t>(Frame::kError)) fail(text_of(payload));
    if (have > size) not_a_frame();
    if (kind != static_cast<std::uint32_t>(wanted)) {
      fail(fmt::format("its process answers {} with a frame of kind {}; {} is due", due.to, kind,
                       static_cast<std::uint32_t>(wanted)));
    }
    return payload;
  }
}

std::span<const unsigned char> Session::exchange(Frame kind, std::span<const char> payload, Frame wanted,
                                                 const Due& due) {
  const std::uint32_t header[] = {static_cast<std::uint32_t>(payload.size()), static_cast<std::uint32_t>(kind)};
  out_.resize(sizeof header + payload.size());
  std::memcpy(out_.data(), header, sizeof header);
  std::memcpy(out_.data() + sizeof header, payload.data(), payload.size());
  if (child_.send(out_, due.until) == Child::Wait::kLate) late(due);
  return answer(wanted, due);  // a process that has ended may have sent its error first
}

void Session::set_up(const std::shared_ptr<const std::string>& setup, double control_period) {
  control_period_ = control_period;
  if (setup_ == setup) return;
  setup_ = nullptr;
  const std::span<const unsigned char> payload =
      exchange(Frame::kSetup, *setup, Frame::kReady, due("to its setup", limits_.start));
  const auto* begin = reinterpret_cast<const char*>(payload.data());
  Json ready;
  try {
    ready = config::parse_json(std::string_view(begin, payload.size()), "its process's answer to its setup");
    const int protocol = ready.at("protocol").get<int>();
    if (protocol != kProcessProtocol)
      fail(fmt::format("its process speaks version {} of the protocol, this moma speaks {}", protocol,
                       kProcessProtocol));
    files_ = ready.value("files", std::vector<std::string>());
  } catch (const PluginError&) {
    throw;
  } catch (const std::exception& error) {
    fail(fmt::format("its process's answer to its setup is not {{\"protocol\": {}, \"files\": [...]}}: {}",
                     kProcessProtocol, error.what()));
  }
  setup_ = setup;
}

void Session::reset(const std::string& shapes, std::size_t numbers) {
  exchange(Frame::kReset, shapes, Frame::kStarted, due("to a reset", limits_.start));
  out_.reserve(kFrameHeader + numbers * sizeof(double));
}

void Session::step(const moma_observation& seen, std::size_t velocities, moma_step_result& result) {
  const std::span<const unsigned char> payload =
      exchange(Frame::kStep, {reinterpret_cast<const char*>(seen.numbers), seen.num_numbers * sizeof(double)},
               Frame::kCommand, due("to a step", limits_.deadline * control_period_));
  constexpr std::size_t kDetails = fixed_numbers<Details>() * sizeof(double);
  const std::size_t plain = velocities * sizeof(double);
  if (payload.size() != plain && payload.size() != plain + kDetails) {
    fail(fmt::format("its process commands {} bytes; {} velocities are {}, or {} with details", payload.size(),
                     velocities, plain, plain + kDetails));
  }
  std::memcpy(result.command, payload.data(), plain);
  if (payload.size() > plain) std::memcpy(plugin::details_of(result), payload.data() + plain, kDetails);
}

}  // namespace moma
