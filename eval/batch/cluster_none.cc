// Replaces cluster_mpi.cc in builds without MPI.
#include <stdexcept>

#include "eval/batch/cluster.h"

namespace moma {

struct Cluster::Impl {};

bool Cluster::built() noexcept { return false; }
Cluster::Cluster(double /*lost_after*/) { throw std::runtime_error("this moma was built without MPI"); }
Cluster::~Cluster() = default;
int Cluster::rank() const { return 0; }
int Cluster::size() const { return 1; }
void Cluster::lead(const std::string& /*setup*/, const std::string& /*machine_class*/,
                   const std::function<void(const std::string&)>& /*note*/) {}
std::size_t Cluster::capacity() const { return 0; }
void Cluster::serve(JobBoard& /*board*/) {}
std::optional<std::string> Cluster::setup() { return std::nullopt; }
void Cluster::refuse(const std::string& /*why*/) {}
void Cluster::work(std::span<const SuitePoint> /*points*/, const std::string& /*machine_class*/,
                   const BatchOptions& /*options*/) {}

}  // namespace moma
