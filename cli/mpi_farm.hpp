#pragma once
/// \file
/// A sweep on the ranks of an MPI job: a plain task farm.

#include "cli/output.hpp"
#include "cli/sweep_watch.hpp"
#include "sweep/farm.hpp"

namespace twincell::cli {

/// The ranks of this job, from the first use of MPI to the end of the object.
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

/// Rank 0 knows the schedule, hands out points, writes their results, and computes points itself beside; the
/// other ranks ask it for work. What goes wrong on any rank ends the whole job, in one sentence and with its
/// exit code; what is done stays done. \param schedule of rank 0; the others pass null
void run_on_ranks(sweep::Schedule* schedule, const sweep::Plan& plan, const sweep::Store& store,
                  bool keep_trajectories, SweepWatch& watch);

}  // namespace twincell::cli
