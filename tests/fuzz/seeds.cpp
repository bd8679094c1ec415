// Writes a few small complete files of each binary format as initial inputs of the fuzzer: seeds FOLDER.
// Those of the text formats are in tests/fuzz/corpus.

#include <filesystem>
#include <fstream>

#include "tests/support/camera_files.hpp"
#include "trajectory/formats/h5md_file.hpp"

using namespace twincell;

namespace {

void save_trajectory(const std::filesystem::path& file, bool full) {
  TrajectoryInfo info;
  info.n_beads = 2;
  info.box.upper = Vec3(4, 1, 6);
  if (full) {
    info.columns = {.velocity = true, .spin = true, .identity = true, .phase = true, .plate_height = true};
    info.drive = Drive{Axis::z, 1.5, 1.0};
    info.drive->ramp =
        DriveRamp{.from = {1.5, 1}, .to = {2, 1.5}, .power = 2, .first = 1, .cycles = 4, .returns = true};
    info.drive->horizontal = HorizontalMotion{.amplitude = 0.5, .ratio = 2, .phase = 0.25};
    info.phases_per_cycle = 2;
    info.columns.contact_forces = true;
    info.walls = {"bottom"};
    info.radius.assign(2, 0.5);
    info.tracer.assign(2, 0);
  }
  H5mdWriter writer(file, info);
  for (int f = 0; f < 3; ++f) {
    Frame frame;
    frame.step = 10 * f;
    frame.time = full ? info.drive->period() * f / 2 : 0.5 * f;
    frame.position = {Vec3(1, 0, 0.5 + f), Vec3(2, 0, 0.5)};
    if (full) {
      frame.phase = f % 2;
      frame.cycle = f / 2;
      frame.velocity = frame.spin = {Vec3(0, 0, 1), Vec3(0, 0, 0)};
      frame.id = {0, 1};
      if (f == 0)
        frame.contact_forces = {{0, -1, 0.01, Vec3::UnitZ(), 1, Vec3::Zero()},
                                {0, 1, 0.01, -Vec3::UnitX(), 1, Vec3::UnitZ()}};
    }
    writer.append(frame);
  }
  writer.finish();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path root = argv[1];
  const auto save = [&](const std::string& format, const std::string& name, const std::string& bytes) {
    std::filesystem::create_directories(root / format);
    std::ofstream(root / format / name, std::ios::binary) << bytes;
  };
  const PixelValue value = [](int x, int y, int f) { return static_cast<unsigned>(x + 5 * y + 20 * f); };
  const auto cine = [&](const std::string& name, CineSpec spec) {
    spec.frames = 2;
    save("cine", name, cine_file(spec, value));
  };
  cine("plain", {});
  cine("eight", {.container = 8, .setup_bytes = 900});
  cine("packed10", {.container = 10, .packing = 256});
  cine("packed12", {.container = 12, .packing = 1024, .flip_v = true});
  cine("old", {.version = 0, .setup_bytes = 200, .times = false});
  save("seq", "old", seq_file({.version = 3}, value));
  save("seq", "deep", seq_file({.bits = 16, .real_bits = 12, .version = 3, .counted = false}, value));
  save("mrf", "eight", mrf_file(4, 3, 2, 8, value));
  save("mrf", "deep", mrf_file(4, 3, 2, 10, value));
  const auto mraw = [&](const std::string& name, const std::string& head, int bits) {
    save("mraw", name, head + '\0' + planes(4, 3, 2, bits, value));
  };
  mraw("twelve", cih_text(4, 3, 2, 12, 12), 12);
  mraw("sixteen", cih_text(4, 3, 2, 16, 12, "Higher"), 16);
  mraw("xml", cihx_text(4, 3, 2, 8, 8).substr(7), 8);
  const auto tiff = [&](const std::string& name, TiffSpec spec) {
    spec.width = 5;
    spec.height = 3;
    save("tiff", name, tiff_file(spec, value));
  };
  tiff("plain", {});
  tiff("big", {.bits = 12, .big_first = true, .big_tiff = true});
  tiff("white", {.bits = 8, .photometric = 0});
  tiff("imagej", {.description = "ImageJ=1.53t\nimages=3\nfinterval=0.1\n", .pages_written = 1});
  std::filesystem::create_directories(root / "h5md");
  for (const bool full : {false, true}) {
    const std::filesystem::path file = root / "h5md" / (full ? "full" : "plain");
    std::filesystem::remove(file);
    save_trajectory(file, full);
  }
}
