// Writes a small trajectory with missing beads, and its content as CSV, to test the readers of other
// programs.
// usage: write_client_sample TRAJECTORY.h5 EXPECTED.csv

#include <cmath>
#include <cstdio>

#include "trajectory/formats/h5md_file.hpp"

int main(int argc, char** argv) {
  using namespace twincell;
  if (argc != 3) return 2;
  TrajectoryInfo info;
  info.n_beads = 50;
  info.columns = {.velocity = true, .spin = true, .identity = true, .phase = true, .plate_height = true};
  info.box.upper = Vec3(20, 1.15, 40);
  info.drive = Drive{Axis::z, 1.5, 1.0};
  info.phases_per_cycle = 20;
  info.radius.assign(50, 0.5);
  info.tracer.assign(50, 0);
  H5mdWriter writer(argv[1], info);
  std::FILE* table = std::fopen(argv[2], "w");
  if (table == nullptr) return 1;
  std::fprintf(table, "frame,time,slot,x,y,z\n");
  for (int f = 0; f < 70; ++f) {
    Frame frame;
    frame.step = 7067 * f;
    frame.time = info.drive->period() * f / 20;
    frame.phase = f % 20;
    frame.cycle = f / 20;
    frame.plate_height = info.drive->displacement(frame.phase / 20.0);
    for (int i = 0; i < 50; ++i) {
      const bool missing = (f + i) % 11 == 0;
      const double nan = std::nan("");
      const Vec3 r(i + 0.1 * std::sin(f), 0, 10 + std::cos(0.3 * f + i));
      frame.position.push_back(missing ? Vec3(nan, nan, nan) : r);
      frame.velocity.push_back(missing ? Vec3(nan, nan, nan) : Vec3(0.1, 0, -0.2));
      frame.spin.push_back(missing ? Vec3(nan, nan, nan) : Vec3(0, 0.5, 0));
      frame.id.push_back(missing ? -1 : i);
      const Vec3& p = frame.position.back();
      std::fprintf(table, "%d,%.17g,%d,%.17g,%.17g,%.17g\n", f, frame.time, i, p.x(), p.y(), p.z());
    }
    writer.append(frame);
  }
  std::fclose(table);
  writer.finish();
  return 0;
}
