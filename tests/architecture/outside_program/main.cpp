// An external program that is built against the installed package.
#include <cstdio>
#include <trajectory/drive.hpp>

int main() {
  const twincell::Drive drive = twincell::solve_drive({.omega = 1.0, .gamma = 1.8}, 1.0, {});
  std::printf("K_m = %.2f\n", drive.k_m());
  return drive.k_m() > 3.2399 && drive.k_m() < 3.2401 ? 0 : 1;
}
