#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "eval/batch/batch.h"

namespace moma {

/// The processes of one `mpirun`. Rank 0 hands out jobs, gets results, and alone writes the store; it computes on
/// threads of its own as well. The others know nothing but the suite that it sends them.
///
/// A rank that is silent for `lost_after` seconds counts as lost: what it had is handed out again, and it gets
/// nothing more. Whether the others outlive it is up to MPI: Open MPI's mpirun ends all of them unless it is told
/// --enable-recovery. Results do not depend on who computed them, so that a lost rank changes only the time.
class Cluster final : public RemoteCompute {
 public:
  /// Whether this program was built with MPI.
  static bool built() noexcept;
  /// Processes that a launcher (Open MPI, MPICH, or Slurm with PMI) started together; 1 where none did. Needs no MPI.
  static int launched() noexcept;

  /// Initialises MPI; once in a program. Throws std::runtime_error where MPI cannot be used.
  explicit Cluster(double lost_after = 30.0);
  /// Rank 0 tells the others to end.
  ~Cluster() override;
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  int rank() const;
  int size() const;

  /// Rank 0: sends `setup` to all others. Only those whose machine class is `machine_class` take part, since others
  /// may differ in last bits; `note` hears of those that do not, and of lost ones.
  void lead(const std::string& setup, const std::string& machine_class,
            const std::function<void(const std::string&)>& note);
  std::size_t capacity() const override;
  void serve(JobBoard& board) override;

  /// Other ranks: what rank 0 sent; nothing where it ended before.
  std::optional<std::string> setup();
  /// Other ranks: says why this one cannot take part.
  void refuse(const std::string& why);
  /// Other ranks: computes what comes in until rank 0 says that it is over. Of `options`: threads, world, parts,
  /// finish.
  void work(std::span<const SuitePoint> points, const std::string& machine_class, const BatchOptions& options);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace moma
