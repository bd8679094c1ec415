// An external program that is built against the installed package. Its argument is a folder of pictures.
#include <analysis/statistics/statistics.hpp>
#include <cstdio>
#include <imaging/locate/locator.hpp>
#include <imaging/stack/open_frames.hpp>
#include <trajectory/drive.hpp>

int main(int, char** argv) {
  const twincell::Drive drive = twincell::solve_drive({.omega = 1.0, .gamma = 1.8}, 1.0, {});
  const double t = twincell::analysis::student_t_95(10);  // 2.228 in every table
  std::printf("K_m = %.2f, t = %.3f\n", drive.k_m(), t);
  cv::Mat frame;
  const bool decoded = twincell::imaging::open_frames(argv[1])->next(frame) && frame.cols > 1;
  twincell::imaging::LocatorOptions options;
  options.diameter_px = 12;
  const std::size_t beads = decoded ? twincell::imaging::locate(frame, options).beads.size() : 0;
  std::printf("%zu beads\n", beads);
  return beads == 100 && drive.k_m() > 3.2399 && drive.k_m() < 3.2401 && t > 2.2281 && t < 2.2282 ? 0 : 1;
}
