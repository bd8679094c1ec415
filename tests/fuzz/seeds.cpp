// Writes a few small whole files of each format, for the fuzzer to begin with: seeds FOLDER.

#include <filesystem>
#include <fstream>

#include "tests/support/camera_files.hpp"

using namespace twincell;

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
}
