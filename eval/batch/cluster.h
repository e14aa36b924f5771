#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "eval/batch/batch.h"

namespace moma {

/// The processes of one `mpirun`. Rank 0 hands out jobs, receives results, and alone writes the store; it also computes
/// on threads of its own. The other ranks know only the suite that it sends them.
///
/// A rank that is silent for `lost_after` seconds counts as lost: its jobs are handed out again, and it gets no more.
/// MPI decides whether the other ranks survive: Open MPI's mpirun ends all of them unless it has the flag
/// --enable-recovery. Results do not depend on the rank that computes them, so that a lost rank changes only the time.
class Cluster final : public RemoteCompute {
 public:
  /// True if this program was built with MPI.
  static bool built() noexcept;
  /// Number of processes that a launcher (Open MPI, MPICH, or Slurm with PMI) started together; 1 without a launcher.
  /// Needs no MPI.
  static int launched() noexcept;

  /// Initialises MPI; once in a program. Throws std::runtime_error if MPI is not usable.
  explicit Cluster(double lost_after = 30.0);
  /// On rank 0: tells the other ranks to end.
  ~Cluster() override;
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  int rank() const;
  int size() const;

  /// Rank 0: sends `setup` to all other ranks. Ranks of another machine class than `machine_class` take no part, since
  /// they may differ in last bits. `note` reports those and lost ranks.
  void lead(const std::string& setup, const std::string& machine_class,
            const std::function<void(const std::string&)>& note);
  std::size_t capacity() const override;
  void serve(JobBoard& board) override;

  /// Other ranks: returns the setup of rank 0; nothing if rank 0 ended before.
  std::optional<std::string> setup();
  /// Other ranks: tells rank 0 why this rank cannot take part.
  void refuse(const std::string& why);
  /// Other ranks: computes jobs until rank 0 ends the batch. Uses threads, world, parts and finish of `options`.
  void work(std::span<const SuitePoint> points, const std::string& machine_class, const BatchOptions& options);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace moma
