#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <list>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include "eval/batch/cluster.h"
#include "eval/batch/wire.h"

namespace moma {
namespace {

using Clock = std::chrono::steady_clock;

enum Tag { kSetup = 1, kHello, kJob, kResult, kAlive, kStop, kBye, kEnd };

// Interval between two MPI polls; a trial takes tens of milliseconds.
constexpr std::chrono::microseconds kPoll{300};
constexpr std::chrono::milliseconds kAlivePeriod{1000};
constexpr std::chrono::minutes kOrphanAfter{10};  // longest silence of rank 0
constexpr std::chrono::seconds kLastWords{2};
constexpr double kJoinPatience = 10.0;  // factor on lost_after while a rank joins: reading a robot takes time
constexpr std::size_t kAhead = 1;       // jobs queued at a rank beyond those that its threads compute

// The job's moves follow it.
struct JobMessage {
  std::uint64_t place = 0;
  std::uint64_t point = 0;
  std::uint64_t world = 0;
};

struct Hello {
  std::uint64_t threads = 0;  // 0: takes no part, with the reason in `text`
  std::string text;           // machine class
};

// Outgoing messages. A send to a lost rank may never complete; nothing waits for it.
class Outbox {
 public:
  void send(int to, Tag tag, const void* data, std::size_t size) {
    const auto* begin = static_cast<const unsigned char*>(data);
    Mail& mail = mails_.emplace_back(Mail{Bytes(begin, begin + size), MPI_REQUEST_NULL});
    MPI_Isend(mail.bytes.data(), static_cast<int>(mail.bytes.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD, &mail.request);
  }
  void sweep() {
    for (auto it = mails_.begin(); it != mails_.end();) {
      int done = 0;
      MPI_Test(&it->request, &done, MPI_STATUS_IGNORE);
      it = done != 0 ? mails_.erase(it) : std::next(it);
    }
  }
  bool empty() const { return mails_.empty(); }

 private:
  struct Mail {
    Bytes bytes;
    MPI_Request request;
  };
  std::deque<Mail> mails_;  // buffers must keep their addresses
};

struct Letter {
  int from = 0;
  int tag = 0;
  Bytes bytes;
};

// Incoming messages. A sender that dies in the middle of a long message leaves it unfinished, and a blocking receive
// would wait for ever: all receives are non-blocking.
class Inbox {
 public:
  /// Returns the next whole message. Messages of one sender come in the order of sending.
  std::optional<Letter> receive(int from = MPI_ANY_SOURCE) {
    int there = 0;
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    while (MPI_Improbe(from, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &message, &status) == MPI_SUCCESS && there != 0) {
      int size = 0;
      MPI_Get_count(&status, MPI_BYTE, &size);
      Arrival& arrival = arrivals_.emplace_back();
      arrival.letter = {status.MPI_SOURCE, status.MPI_TAG, Bytes(static_cast<std::size_t>(size))};
      MPI_Imrecv(arrival.letter.bytes.data(), size, MPI_BYTE, &message, &arrival.request);
    }
    std::set<int> unfinished;  // senders
    for (auto it = arrivals_.begin(); it != arrivals_.end(); ++it) {
      if (unfinished.contains(it->letter.from)) continue;
      int done = 0;
      if (MPI_Test(&it->request, &done, MPI_STATUS_IGNORE) == MPI_SUCCESS && done != 0) {
        Letter letter = std::move(it->letter);
        arrivals_.erase(it);
        return letter;
      }
      unfinished.insert(it->letter.from);
    }
    return std::nullopt;
  }

 private:
  struct Arrival {
    Letter letter;
    MPI_Request request = MPI_REQUEST_NULL;
  };
  std::list<Arrival> arrivals_;  // buffers must keep their addresses
};

/// Rank 0's record of another rank.
struct Worker {
  bool joined = false;
  bool gone = false;  // gets no work: lost or refused
  bool lost = false;
  bool left = false;               // sent its farewell
  std::size_t room = 0;            // jobs that it takes at once
  std::vector<std::uint64_t> out;  // tickets of its present jobs
  Clock::time_point heard;
};

/// A job in progress elsewhere. Ticket numbers are never reused, so that a late result of an earlier batch is
/// recognised.
struct Ticket {
  std::uint64_t number = 0;
  std::size_t place = 0;
};

}  // namespace

struct Cluster::Impl {
  int rank = 0;
  int size = 1;
  std::chrono::duration<double> lost_after{30.0};
  Inbox inbox;
  Outbox outbox;
  std::vector<Worker> workers;  // by rank; 0 is unused
  std::vector<Ticket> tickets;
  std::uint64_t next_ticket = 0;
  std::string machine_class;
  std::function<void(const std::string&)> note;
  Clock::time_point told = Clock::now();
  bool lost_one = false;

  // Rank 0 ----------------------------------------------------------------------------------------------------------
  void lose(std::size_t w, const std::string& why, JobBoard* board) {
    Worker& worker = workers[w];
    if (worker.gone) return;
    worker.gone = true;
    if (note) note(fmt::format("rank {}: {}", w, why));
    for (const std::uint64_t number : worker.out) {
      const auto ticket = find(number);
      if (board != nullptr) board->give_back(ticket->place);
      tickets.erase(ticket);
    }
    worker.out.clear();
  }

  std::vector<Ticket>::iterator find(std::uint64_t number) {
    return std::ranges::find_if(tickets, [&](const Ticket& t) { return t.number == number; });
  }

  void hello(std::size_t w, const Letter& letter) {
    Worker& worker = workers[w];
    std::uint64_t threads = 0;
    if (letter.bytes.size() < sizeof threads) return;
    std::memcpy(&threads, letter.bytes.data(), sizeof threads);
    const std::string text(letter.bytes.begin() + sizeof threads, letter.bytes.end());
    if (threads == 0) return lose(w, text + "; it takes no part", nullptr);
    if (text != machine_class)
      return lose(
          w, fmt::format("its machine is of another class ({}), which may change last bits; it takes no part", text),
          nullptr);
    worker.joined = true;
    worker.room = static_cast<std::size_t>(threads) + kAhead;
  }

  void result(std::size_t w, const Letter& letter, JobBoard& board) {
    DecodedResult decoded = decode_result(letter.bytes);
    std::erase(workers[w].out, decoded.place);
    const auto ticket = find(decoded.place);
    if (ticket == tickets.end()) return;  // from a rank that was given up
    const std::size_t place = ticket->place;
    tickets.erase(ticket);
    board.put(place, std::move(decoded.result));
  }

  bool hand_out(JobBoard& board) {
    bool any = false;
    for (std::size_t w = 1; w < workers.size(); ++w) {
      Worker& worker = workers[w];
      while (worker.joined && !worker.gone && worker.out.size() < worker.room) {
        const std::optional<std::size_t> place = board.try_take();
        if (!place) return any;
        const Ticket ticket{next_ticket++, *place};
        tickets.push_back(ticket);
        worker.out.push_back(ticket.number);
        const BatchJob& job = board.job(*place);
        const JobMessage message{ticket.number, job.point, job.world};
        Bytes bytes(sizeof message + (job.moves ? job.moves->size() * sizeof(Move) : 0));
        std::memcpy(bytes.data(), &message, sizeof message);
        if (job.moves) std::memcpy(bytes.data() + sizeof message, job.moves->data(), bytes.size() - sizeof message);
        outbox.send(static_cast<int>(w), kJob, bytes.data(), bytes.size());
        any = true;
      }
    }
    return any;
  }

  void look_for_lost(JobBoard& board) {
    const auto now = Clock::now();
    for (std::size_t w = 1; w < workers.size(); ++w) {
      const auto patience = lost_after * (workers[w].joined ? 1.0 : kJoinPatience);
      if (workers[w].gone || now - workers[w].heard <= patience) continue;
      lost_one = workers[w].lost = true;
      lose(w,
           fmt::format("no word for {:.0f} s; its {} trials are handed out again",
                       std::chrono::duration<double>(patience).count(), workers[w].out.size()),
           &board);
    }
  }

  void tell_alive() {
    if (Clock::now() - told <= kAlivePeriod) return;
    told = Clock::now();
    for (std::size_t w = 1; w < workers.size(); ++w)
      if (!workers[w].gone) outbox.send(static_cast<int>(w), kAlive, nullptr, 0);
  }

  bool anyone() const {
    return std::any_of(workers.begin() + 1, workers.end(), [](const Worker& worker) { return !worker.gone; });
  }

  void collect_farewells() {
    for (int w = 1; w < size; ++w) outbox.send(w, kStop, nullptr, 0);
    const auto end = Clock::now() + lost_after;
    const auto waiting = [&] {
      return std::any_of(workers.begin() + 1, workers.end(), [](const Worker& w) { return !w.lost && !w.left; });
    };
    while (waiting() && Clock::now() < end) {
      while (const std::optional<Letter> letter = inbox.receive())  // including results that no one waits for any more
        if (letter->tag == kBye) workers[static_cast<std::size_t>(letter->from)].left = true;
      outbox.sweep();
      std::this_thread::sleep_for(kPoll);
    }
    lost_one = lost_one || waiting();
    const char missing = lost_one ? 1 : 0;
    for (int w = 1; w < size; ++w) outbox.send(w, kEnd, &missing, 1);
  }

  // Other ranks -----------------------------------------------------------------------------------------------------
  void wait_for_end() {
    const auto end = Clock::now() + kOrphanAfter;
    while (Clock::now() < end) {
      while (const std::optional<Letter> letter = inbox.receive(0)) {
        if (letter->tag != kEnd) continue;
        lost_one = !letter->bytes.empty() && letter->bytes[0] != 0;
        return;
      }
      outbox.sweep();
      std::this_thread::sleep_for(kPoll);
    }
    lost_one = true;
  }

  void say_hello(std::uint64_t threads, const std::string& text) {
    Bytes bytes(sizeof threads);
    std::memcpy(bytes.data(), &threads, sizeof threads);
    bytes.insert(bytes.end(), text.begin(), text.end());
    outbox.send(0, kHello, bytes.data(), bytes.size());
  }
};

bool Cluster::built() noexcept { return true; }

Cluster::Cluster(double lost_after) : impl_(std::make_unique<Impl>()) {
  int provided = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS ||
      provided < MPI_THREAD_FUNNELED)
    throw std::runtime_error("MPI cannot be initialised for programs with threads");
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  MPI_Comm_rank(MPI_COMM_WORLD, &impl_->rank);
  MPI_Comm_size(MPI_COMM_WORLD, &impl_->size);
  impl_->lost_after = std::chrono::duration<double>(lost_after);
  impl_->workers.resize(static_cast<std::size_t>(impl_->size));
}

// MPI_Finalize waits for every rank, and for ever if one is lost. All ranks therefore send a farewell first, and rank 0
// tells them whether one is missing: then none finalises.
Cluster::~Cluster() {
  Impl& self = *impl_;
  if (self.rank == 0) {
    self.collect_farewells();
  } else {
    self.outbox.send(0, kBye, nullptr, 0);
    self.wait_for_end();
  }
  const auto end = Clock::now() + kLastWords;
  while (!self.outbox.empty() && Clock::now() < end) {
    self.outbox.sweep();
    std::this_thread::sleep_for(kPoll);
  }
  if (!self.lost_one && self.outbox.empty()) MPI_Finalize();
}

int Cluster::rank() const { return impl_->rank; }
int Cluster::size() const { return impl_->size; }

void Cluster::lead(const std::string& setup, const std::string& machine_class,
                   const std::function<void(const std::string&)>& note) {
  impl_->machine_class = machine_class;
  impl_->note = note;
  for (int w = 1; w < impl_->size; ++w) {
    impl_->workers[static_cast<std::size_t>(w)].heard = Clock::now();
    impl_->outbox.send(w, kSetup, setup.data(), setup.size());
  }
}

std::size_t Cluster::capacity() const {
  std::size_t sum = 0;
  for (std::size_t w = 1; w < impl_->workers.size(); ++w) {
    const Worker& worker = impl_->workers[w];
    if (!worker.gone) sum += std::max<std::size_t>(worker.room, 2);
  }
  return sum;
}

void Cluster::serve(JobBoard& board) {
  Impl& self = *impl_;
  while (self.anyone()) {
    bool any = false;
    while (const std::optional<Letter> letter = self.inbox.receive()) {
      any = true;
      const auto w = static_cast<std::size_t>(letter->from);
      self.workers[w].heard = Clock::now();
      if (letter->tag == kHello) self.hello(w, *letter);
      if (letter->tag == kResult) self.result(w, *letter, board);
    }
    self.outbox.sweep();
    self.look_for_lost(board);
    self.tell_alive();
    if (board.closed() && self.tickets.empty()) return;
    any = self.hand_out(board) || any;
    if (!any) std::this_thread::sleep_for(kPoll);
  }
}

std::optional<std::string> Cluster::setup() {
  while (true) {
    if (const auto letter = impl_->inbox.receive(0)) {
      if (letter->tag == kSetup) return std::string(letter->bytes.begin(), letter->bytes.end());
      if (letter->tag == kStop) return std::nullopt;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void Cluster::refuse(const std::string& why) {
  impl_->say_hello(0, why);
  BatchOptions none;
  none.threads = 0;
  work({}, "", none);
}

void Cluster::work(std::span<const SuitePoint> points, const std::string& machine_class, const BatchOptions& options) {
  Impl& self = *impl_;
  const auto threads = static_cast<std::size_t>(std::max(options.threads, 0));
  if (threads > 0) self.say_hello(threads, machine_class);
  std::mutex mutex;
  std::condition_variable come;
  struct Task {
    std::uint64_t place = 0;
    BatchJob job;
  };
  std::deque<Task> tasks;
  std::deque<Bytes> results;
  bool over = false;
  const auto compute = [&] {
    while (true) {
      std::unique_lock lock(mutex);
      come.wait(lock, [&] { return over || !tasks.empty(); });
      if (over) return;
      const Task task = std::move(tasks.front());
      tasks.pop_front();
      lock.unlock();
      Bytes bytes = encode_result(task.place, compute_job(points[task.job.point], task.job, options));
      lock.lock();
      results.push_back(std::move(bytes));
    }
  };
  std::vector<std::thread> team;
  for (std::size_t i = 0; i < threads; ++i) team.emplace_back(compute);
  auto alive = Clock::now();
  auto heard = Clock::now();
  while (!over) {
    while (const std::optional<Letter> letter = self.inbox.receive(0)) {
      heard = Clock::now();
      const std::scoped_lock lock(mutex);
      if (letter->tag == kStop) {
        over = true;
        come.notify_all();
      } else if (letter->tag == kJob && letter->bytes.size() >= sizeof(JobMessage)) {
        JobMessage message;
        std::memcpy(&message, letter->bytes.data(), sizeof message);
        Task task{message.place, {static_cast<std::size_t>(message.point), message.world, {}}};
        const std::size_t count = (letter->bytes.size() - sizeof message) / sizeof(Move);
        if (count > 0) {
          auto moves = std::make_shared<Moves>(count);
          std::memcpy(moves->data(), letter->bytes.data() + sizeof message, count * sizeof(Move));
          task.job.moves = std::move(moves);
        }
        if (message.point < points.size()) tasks.push_back(std::move(task));
        come.notify_one();
      }
    }
    if (Clock::now() - heard > kOrphanAfter) {
      const std::scoped_lock lock(mutex);
      over = true;
      come.notify_all();
    }
    std::deque<Bytes> ready;
    {
      const std::scoped_lock lock(mutex);
      ready.swap(results);
    }
    for (const Bytes& bytes : ready) self.outbox.send(0, kResult, bytes.data(), bytes.size());
    self.outbox.sweep();
    if (Clock::now() - alive > kAlivePeriod) {
      alive = Clock::now();
      self.outbox.send(0, kAlive, nullptr, 0);
    }
    if (!over && ready.empty()) std::this_thread::sleep_for(kPoll);
  }
  for (std::thread& thread : team) thread.join();
}

}  // namespace moma
