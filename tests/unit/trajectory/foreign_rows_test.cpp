// H5MD files of other programs: rows that change their beads, images, wrapped positions, and boxes per frame.

#include "trajectory/formats/foreign_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/hdf5.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::foreign_rows_test {
namespace {

constexpr int kFrames = 12;
constexpr double kPeriod = 10;

/// True position of a bead: three beads that drift at different speeds, one of them two periods in all.
Vec3 truth(int frame, std::size_t bead) {
  const double speeds[] = {1.9, -0.4, 0.1};
  return {1.5 + 3 * static_cast<double>(bead) + speeds[bead] * frame, 0.5, 2 + static_cast<double>(bead)};
}

double images_of(double x) {
  return std::floor(x / kPeriod);
}

/// How a file is written.
struct Layout {
  bool permuted = false, images = false, wrapped = true;
  double lower = 0;              ///< where the period of the positions begins
  double last_period = kPeriod;  ///< of the last frame
  std::int64_t first_id = 100;
};

void write_foreign(const std::filesystem::path& path, const Layout& how) {
  h5::quiet();
  const h5::Handle file =
      h5::own(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "creating");
  h5::write_attribute(h5::create_group(file.get(), "h5md").get(), "version", std::vector<int>{1, 1});
  const h5::Handle particles = h5::create_group(file.get(), "particles");
  const h5::Handle group = h5::create_group(particles.get(), "all");
  const h5::Handle box = h5::create_group(group.get(), "box");
  h5::write_attribute(box.get(), "boundary", std::vector<std::string>{"periodic", "none", "none"});
  const h5::Handle edges = h5::create_group(box.get(), "edges"),
                   position = h5::create_group(group.get(), "position"),
                   id = h5::create_group(group.get(), "id"), image = h5::create_group(group.get(), "image");
  h5::Series sizes(edges.get(), "value", H5T_IEEE_F64LE, {3}),
      steps(position.get(), "step", H5T_STD_I64LE, {}), times(position.get(), "time", H5T_IEEE_F64LE, {}),
      places(position.get(), "value", H5T_IEEE_F64LE, {3, 3}), ids, images;
  if (how.permuted) ids = h5::Series(id.get(), "value", H5T_STD_I64LE, {3});
  if (how.images) images = h5::Series(image.get(), "value", H5T_STD_I32LE, {3, 3});
  for (std::int64_t f = 0; f < kFrames; ++f) {
    const double time = 0.5 * static_cast<double>(f),
                 size[3] = {f + 1 < kFrames ? kPeriod : how.last_period, 1, 10};
    double r[9], moved[9] = {};
    std::int64_t named[3];
    for (std::size_t row = 0; row < 3; ++row) {
      const std::size_t bead = how.permuted ? (row + static_cast<std::size_t>(f)) % 3 : row;
      Vec3 at = truth(static_cast<int>(f), bead);
      moved[3 * row] = images_of(at.x() - how.lower);
      if (how.wrapped) at.x() -= kPeriod * moved[3 * row];
      for (int k = 0; k < 3; ++k) r[3 * row + static_cast<std::size_t>(k)] = at[k];
      named[row] = how.first_id + 7 * static_cast<std::int64_t>(bead);
    }
    sizes.append(h5::native<double>(), size);
    steps.append(h5::native<std::int64_t>(), &f);
    times.append(h5::native<double>(), &time);
    places.append(h5::native<double>(), r);
    if (how.permuted) ids.append(h5::native<std::int64_t>(), named);
    if (how.images) images.append(h5::native<double>(), moved);
  }
}

/// The largest error of a displacement since the first frame, and whether the box is right.
double worst(const Layout& how, bool backwards = false) {
  const TemporaryFolder folder;
  write_foreign(folder / "f.h5", how);
  const H5mdReader reader(folder / "f.h5");
  EXPECT_EQ(reader.info().box.size().x(), kPeriod);
  Frame first, frame;
  reader.read(0, first);
  double most = 0;
  for (int k = 0; k < kFrames; ++k) {
    const int f = backwards ? kFrames - 1 - k : k;
    reader.read(static_cast<std::size_t>(f), frame);
    for (std::size_t i = 0; i < 3; ++i)
      most = std::max(most, ((frame.position[i] - first.position[i]) - (truth(f, i) - truth(0, i))).norm());
  }
  return most;
}

TEST(ForeignRows, BeadsMoveAsTheyDoHoweverTheyAreStored) {
  for (const bool permuted : {false, true})
    for (const bool images : {false, true})
      for (const double lower : {0.0, -5.0})
        for (const bool backwards : {false, true})
          EXPECT_LT(worst({.permuted = permuted, .images = images, .lower = lower}, backwards), 1e-12)
              << permuted << images << lower << backwards;
  EXPECT_LT(worst({.wrapped = false}), 1e-12);
  EXPECT_LT(worst({.permuted = true, .wrapped = false}), 1e-12);
}

TEST(ForeignRows, ABoxThatChangesIsRefused) {
  const TemporaryFolder folder;
  write_foreign(folder / "f.h5", {.last_period = 9.5});
  EXPECT_NE(complaint_of([&] {
              H5mdReader(folder / "f.h5");
            }).find("box/edges: the box of frame 11 is not that of the first one."),
            std::string::npos);
}

}  // namespace
}  // namespace twincell::foreign_rows_test
