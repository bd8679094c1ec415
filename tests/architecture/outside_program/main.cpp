// An external program that is built against the installed package.
#include <analysis/statistics/statistics.hpp>
#include <cstdio>
#include <trajectory/drive.hpp>

int main() {
  const twincell::Drive drive = twincell::solve_drive({.omega = 1.0, .gamma = 1.8}, 1.0, {});
  const double t = twincell::analysis::student_t_95(10);  // 2.228 in every table
  std::printf("K_m = %.2f, t = %.3f\n", drive.k_m(), t);
  return drive.k_m() > 3.2399 && drive.k_m() < 3.2401 && t > 2.2281 && t < 2.2282 ? 0 : 1;
}
