#pragma once
/// \file
/// Runs a sweep on the ranks of an MPI job, as a task farm.

#include "cli/output.hpp"
#include "cli/sweep_watch.hpp"
#include "sweep/farm.hpp"

namespace twincell::cli {

/// Initialises MPI when constructed and finalises it when destroyed.
/// \throws ConfigError if the program was built without MPI
class MpiJob {
 public:
  MpiJob();
  ~MpiJob();
  MpiJob(const MpiJob&) = delete;
  MpiJob& operator=(const MpiJob&) = delete;
  [[nodiscard]] bool is_master() const { return rank_ == 0; }

 private:
  int rank_ = 0;
};

/// Rank 0 has the schedule, distributes the points, stores their results, and also computes points itself.
/// The other ranks compute the points that they receive. An error on any rank ends the whole job with one
/// sentence and the exit code of the error; finished points are kept.
/// \param schedule of rank 0; null on the other ranks
void run_on_ranks(sweep::Schedule* schedule, const sweep::Plan& plan, const sweep::Store& store,
                  bool keep_trajectories, SweepWatch& watch);

}  // namespace twincell::cli
