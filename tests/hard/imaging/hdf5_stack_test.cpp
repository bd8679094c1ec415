// Image stacks in HDF5 files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numeric>

#include "core/hdf5.hpp"
#include "imaging/stack/open_frames.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/frames.hpp"
#include "tests/support/hdf5_elsewhere.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::hdf5_stack_test {

using namespace imaging;

namespace {

/// Writes the values 0, 1, 2 … as a dataset of the given type and shape; an empty chunk means contiguous.
void add_dataset(hid_t file, const std::string& path, hid_t type, const std::vector<hsize_t>& shape,
                 const std::vector<hsize_t>& chunk = {}) {
  const h5::Handle space =
      h5::own(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), "space");
  const h5::Handle create = h5::own(H5Pcreate(H5P_DATASET_CREATE), "plist");
  if (!chunk.empty()) {
    H5Pset_chunk(create.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_deflate(create.get(), 1);
  }
  const h5::Handle links = h5::own(H5Pcreate(H5P_LINK_CREATE), "plist");
  H5Pset_create_intermediate_group(links.get(), 1);
  const h5::Handle dataset = h5::own(
      H5Dcreate2(file, path.c_str(), type, space.get(), links.get(), create.get(), H5P_DEFAULT), path);
  std::vector<std::int32_t> values(
      std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>()));
  std::iota(values.begin(), values.end(), 0);
  h5::check(H5Dwrite(dataset.get(), H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
            "writing");
}

h5::Handle new_file(const std::string& path) {
  h5::quiet();
  return h5::own(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), path);
}

void expect_counting(const std::string& stack, int type, int frames, int rows, int columns) {
  EXPECT_EQ(open_frames(stack)->announced(), static_cast<std::size_t>(frames));
  const auto read = read_all(stack);
  ASSERT_EQ(read.size(), static_cast<std::size_t>(frames));
  int count = 0;
  for (const cv::Mat& frame : read) {
    ASSERT_EQ(frame.type(), type);
    ASSERT_EQ(frame.size(), cv::Size(columns, rows));
    cv::Mat real;
    frame.convertTo(real, CV_64F);
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x, ++count) ASSERT_EQ(real.at<double>(y, x), count);
  }
}

}  // namespace

TEST(Hdf5Stack, TheOnlyOneOrByItsPath) {
  const TemporaryFolder folder;
  const std::string one = folder / "one.h5", two = folder / "two.hdf5";
  {
    const h5::Handle file = new_file(one);
    add_dataset(file.get(), "/camera/frames", H5T_STD_U16LE, {4, 5, 6}, {1, 5, 6});
    add_dataset(file.get(), "/camera/times", H5T_IEEE_F64LE, {4});
  }
  expect_counting(one, CV_16UC1, 4, 5, 6);
  expect_counting(one + ":/camera/frames", CV_16UC1, 4, 5, 6);
  EXPECT_EQ(file_of_stack(one + ":/camera/frames"), one);
  EXPECT_EQ(file_of_stack(one), one);
  {
    const h5::Handle file = new_file(two);
    add_dataset(file.get(), "/a", H5T_STD_U8LE, {2, 3, 4});
    add_dataset(file.get(), "/b", H5T_STD_U16BE, {2, 3, 4}, {2, 2, 2});
  }
  expect_words(refusal(two), {"two.hdf5", "2 datasets", "/a (2 x 3 x 4)", "/b (2 x 3 x 4)", "two.hdf5:/a"});
  expect_counting(two + ":/a", CV_8UC1, 2, 3, 4);
  expect_counting(two + ":/b", CV_16UC1, 2, 3, 4);
  EXPECT_EQ(open_frames(two + ":/a")->info().bits, 8);
}

TEST(Hdf5Stack, AllKindsOfNumbersAndChunks) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  {
    const h5::Handle file = new_file(path);
    const h5::Handle twelve = h5::own(H5Tcopy(H5T_STD_U16LE), "type");
    H5Tset_precision(twelve.get(), 12);
    add_dataset(file.get(), "/twelve", twelve.get(), {7, 5, 6});
    add_dataset(file.get(), "/int", H5T_STD_I16LE, {7, 5, 6}, {3, 2, 4});
    add_dataset(file.get(), "/long", H5T_STD_U32BE, {7, 5, 6}, {7, 5, 1});
    add_dataset(file.get(), "/real", H5T_IEEE_F64LE, {7, 5, 6}, {2, 5, 6});
  }
  expect_counting(path + ":/twelve", CV_16UC1, 7, 5, 6);
  EXPECT_EQ(open_frames(path + ":/twelve")->info().bits, 12);
  for (const char* name : {":/int", ":/long", ":/real"}) expect_counting(path + name, CV_32FC1, 7, 5, 6);
}

TEST(Hdf5Stack, Spoilt) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  {
    const h5::Handle file = new_file(path);
    add_dataset(file.get(), "/flat", H5T_STD_U8LE, {3, 4});
    add_dataset(file.get(), "/group/none", H5T_STD_U8LE, {0, 3, 4});
  }
  expect_words(refusal(path), {"a.h5", "holds no frames in /group/none"});
  expect_words(refusal(path + ":/flat"), {"2 dimensions in /flat"});
  expect_words(refusal(path + ":/group"), {"that is a group"});
  expect_words(refusal(path + ":/missing/one"), {"no dataset /missing/one"});
  {
    const h5::Handle file = new_file(path);
    add_dataset(file.get(), "/flat", H5T_STD_U8LE, {3, 4});
  }
  expect_words(refusal(path), {"no dataset of three dimensions"});
  {
    const h5::Handle file = new_file(path);
    h5::create_group(file.get(), "h5md");
    add_dataset(file.get(), "/particles/position", H5T_IEEE_F64LE, {3, 4, 3});
  }
  expect_words(refusal(path), {"trajectory (H5MD)"});
  {
    const h5::Handle file = new_file(path);
    const h5::Handle create = h5::own(H5Pcreate(H5P_DATASET_CREATE), "plist");
    const std::vector<hsize_t> shape = {10, 1000000, 100}, chunk = {1, 100, 100};
    H5Pset_chunk(create.get(), 3, chunk.data());
    const h5::Handle space = h5::own(H5Screate_simple(3, shape.data(), nullptr), "space");
    const h5::Handle dataset = h5::own(
        H5Dcreate2(file.get(), "/a", H5T_STD_U8LE, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT),
        "dataset");
  }
  expect_words(refusal(path), {"100 x 1000000", "cannot hold"});
  {
    const h5::Handle file = new_file(path);
    add_dataset(file.get(), "/a", H5T_STD_U16LE, {4, 50, 60}, {1, 50, 60});
  }
  const std::string whole = bytes_of(path);
  ASSERT_EQ(refusal(path), "");
  for (std::size_t n = 8; n < whole.size(); n += 97) {
    put_file(path, whole.substr(0, n));
    const std::string sentence = refusal(path);
    EXPECT_NE(sentence.find("a.h5"), std::string::npos) << n << " of " << whole.size() << " bytes";
    EXPECT_EQ(std::count(sentence.begin(), sentence.end(), '\n'), 0) << sentence;
  }
  put_file(path, "no HDF5");
  expect_words(refusal(path + ":/a"), {"a.h5"});
}

// Blank frames compress to a thousandth: some hundred kilobytes may claim a quarter of a gigabyte.
TEST(Hdf5Stack, LargeCompressedDatasetsAreReadOrRefused) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  const auto blank = [&](const std::vector<hsize_t>& shape, const std::vector<hsize_t>& chunk) {
    const h5::Handle file = new_file(path);
    const h5::Handle create = h5::own(H5Pcreate(H5P_DATASET_CREATE), "plist");
    H5Pset_chunk(create.get(), 3, chunk.data());
    H5Pset_deflate(create.get(), 9);
    const h5::Handle space = h5::own(H5Screate_simple(3, shape.data(), nullptr), "space");
    const h5::Handle dataset = h5::own(
        H5Dcreate2(file.get(), "/a", H5T_STD_U8LE, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT), "a");
    const std::vector<std::uint8_t> zeros(shape[0] * shape[1] * shape[2], 0);
    h5::check(H5Dwrite(dataset.get(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data()), "a");
  };
  blank({1, 16384, 16384}, {1, 16384, 16384});
  ASSERT_GT(bytes_of(path).size(), 200'000U);
  expect_words(refusal(path), {"a.h5", "16384 x 16384", "cannot hold"});
  // The stored bytes of another dataset must not count for this one.
  {
    const h5::Handle file = h5::own(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), path);
    add_dataset(file.get(), "/padding", H5T_STD_I32LE, {1000, 1000});
  }
  expect_words(refusal(path), {"a.h5", "16384 x 16384", "cannot hold"});
  blank({4, 100, 100}, {4, 100, 100});
  EXPECT_EQ(refusal(path), "");
  {
    const h5::Handle file = new_file(path);
    const h5::Handle create = h5::own(H5Pcreate(H5P_DATASET_CREATE), "plist");
    const std::vector<hsize_t> shape = {1, 64, 64}, largest = {H5S_UNLIMITED, H5S_UNLIMITED, H5S_UNLIMITED},
                               chunk = {16384, 256, 256};
    H5Pset_chunk(create.get(), 3, chunk.data());
    const h5::Handle space = h5::own(H5Screate_simple(3, shape.data(), largest.data()), "space");
    const h5::Handle dataset = h5::own(
        H5Dcreate2(file.get(), "/a", H5T_STD_U8LE, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT), "a");
  }
  expect_words(refusal(path), {"a.h5", "chunks of /a", "16384 x 256 x 256", "cannot hold"});
}

// The stored bytes must account for all frames of a stack, not only for one: otherwise a file of zeros costs
// its reader hours.
TEST(Hdf5Stack, MoreFramesThanAreStored) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  const auto claim = [&](hsize_t frames, const std::vector<hsize_t>& chunk) {
    const h5::Handle file = new_file(path);
    const h5::Handle create = h5::own(H5Pcreate(H5P_DATASET_CREATE), "plist");
    if (!chunk.empty()) {
      h5::check(H5Pset_chunk(create.get(), 3, chunk.data()), "chunk");
      h5::check(H5Pset_deflate(create.get(), 1), "deflate");
    }
    const std::vector<hsize_t> shape = {frames, 100, 100}, first = {1, 100, 100}, start = {0, 0, 0};
    const h5::Handle space = h5::own(H5Screate_simple(3, shape.data(), nullptr), "space");
    const h5::Handle dataset = h5::own(
        H5Dcreate2(file.get(), "/a", H5T_STD_U8LE, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT), "a");
    if (chunk.empty()) return;  // the first frame written would store all
    const h5::Handle memory = h5::own(H5Screate_simple(3, first.data(), nullptr), "space");
    h5::check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, first.data(), nullptr),
              "a");
    std::vector<std::uint8_t> pixels(10'000);
    std::iota(pixels.begin(), pixels.end(), std::uint8_t{0});
    h5::check(
        H5Dwrite(dataset.get(), H5T_NATIVE_UINT8, memory.get(), space.get(), H5P_DEFAULT, pixels.data()),
        "a");
  };
  claim(100'000'000, {1, 100, 100});
  expect_words(refusal(path), {"a.h5", "/a", "claims 1e+12 bytes"});
  claim(100'000'000, {});
  expect_words(refusal(path), {"a.h5", "/a", "claims 1e+12 bytes", "holds 0"});
  // A recording planned for one second that stopped after its first frame is accepted: missing frames are
  // black.
  claim(100, {1, 100, 100});
  EXPECT_EQ(refusal(path), "");
  EXPECT_EQ(read_all(path).size(), 100U);
}

// Zeros deflated twice shrink to a millionth, and they are decompressed before their size is compared with
// that of a chunk.
TEST(Hdf5Stack, DeflatedTwice) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  const auto write_deflated = [&](int times) {
    const h5::Handle file = new_file(path);
    const h5::Handle create = h5::own(H5Pcreate(H5P_DATASET_CREATE), "plist");
    const std::vector<hsize_t> shape = {2, 5, 6};
    h5::check(H5Pset_chunk(create.get(), 3, shape.data()), "chunk");
    for (int i = 0; i < times; ++i) h5::check(H5Pset_deflate(create.get(), 9), "deflate");
    const h5::Handle space = h5::own(H5Screate_simple(3, shape.data(), nullptr), "space");
    const h5::Handle dataset = h5::own(
        H5Dcreate2(file.get(), "/a", H5T_STD_U8LE, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT), "a");
    const std::vector<std::uint8_t> zeros(60);
    h5::check(H5Dwrite(dataset.get(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data()), "a");
  };
  write_deflated(1);
  EXPECT_EQ(refusal(path), "");
  write_deflated(2);
  expect_words(refusal(path), {"a.h5", "/a", "compressed 2 times"});
}

// Otherwise a foreign file could expose the bytes of any file of the account as grey values. HDF5 also fills
// a virtual dataset whose files are missing with zeros.
TEST(Hdf5Stack, DataInOtherFilesIsNotRead) {
  const TemporaryFolder folder;
  const std::string secret = folder / "secret";
  std::ofstream(secret) << "twenty-four bytes of text";
  for (const std::string kind : {"link", "virtual", "external"}) {
    const std::string file = folder / (kind + ".h5");
    {
      const h5::Handle f = new_file(file);
      add_dataset(f.get(), "frames", H5T_STD_U8LE, {2, 3, 4});
      test::add_elsewhere(f.get(), kind, secret);
    }
    for (const std::string& stack : {file, file + ":/frames"}) {
      try {
        (void)open_frames(stack);
        ADD_FAILURE() << stack << " was opened";
      } catch (const InputError& e) {
        EXPECT_NE(
            std::string(e.what()).find(kind == "link" ? "/linked is a link to another file" : "/" + kind),
            std::string::npos)
            << e.what();
      }
    }
  }
}

}  // namespace twincell::hdf5_stack_test
