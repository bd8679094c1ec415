// HDF5 files on which the HDF5 library crashes or never ends are refused before the program reads them.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "core/error.hpp"
#include "core/hdf5_open.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::hdf5_damage_test {
namespace {

/// The bytes of a file with one dataset of frames, stored in chunks, in a group. HDF5 writes it in its oldest
/// format, whose structures begin with signatures.
std::string sound_file() {
  const TemporaryFolder folder;
  const std::string path = folder / "sound.h5";
  {
    h5::quiet();
    const h5::Handle file = h5::own(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), path);
    const h5::Handle group = h5::create_group(file.get(), "camera");
    const std::array<hsize_t, 3> shape = {2, 30, 40}, chunk = {1, 30, 40};
    const h5::Handle space = h5::own(H5Screate_simple(3, shape.data(), nullptr), "space");
    const h5::Handle create = h5::own(H5Pcreate(H5P_DATASET_CREATE), "plist");
    h5::check(H5Pset_chunk(create.get(), 3, chunk.data()), "chunk");
    const h5::Handle frames = h5::own(
        H5Dcreate2(group.get(), "frames", H5T_STD_U8LE, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT),
        "frames");
    const std::vector<std::uint8_t> pixels(2 * 30 * 40, 7);
    h5::check(H5Dwrite(frames.get(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, pixels.data()),
              "frames");
  }
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::uint64_t number_at(const std::string& bytes, std::size_t at) {
  std::uint64_t value = 0;
  std::memcpy(&value, &bytes.at(at), sizeof value);
  return value;
}
void put_number(std::string& bytes, std::size_t at, std::uint64_t value) {
  std::memcpy(&bytes.at(at), &value, sizeof value);
}

/// Makes a node of a B-tree its own child: "TREE", type (0 of groups, 1 of chunks), level, number of entries
/// in 2 bytes, two siblings of 8 bytes, a key, and the first child.
std::string with_own_child(char type, std::size_t bytes_of_key) {
  std::string bytes = sound_file();
  const std::size_t node = bytes.find(std::string("TREE") + type), child = node + 24 + bytes_of_key;
  EXPECT_NE(node, std::string::npos);
  bytes[node + 5] = 1;
  put_number(bytes, child, node);
  return bytes;
}

/// Makes the first free block of a heap of names its own successor: "HEAP", 4 bytes, the size, the place of
/// the first free block, and the address of the heap's data.
std::string with_endless_list() {
  std::string bytes = sound_file();
  const std::size_t heap = bytes.find("HEAP");
  EXPECT_NE(heap, std::string::npos);
  const std::uint64_t block = number_at(bytes, heap + 16);
  put_number(bytes, number_at(bytes, heap + 24) + block, block);
  return bytes;
}

struct Damaged {
  std::string name, bytes;
};
std::vector<Damaged> damaged_files() {
  constexpr std::size_t kChunkKey = 8 + 8 * 4;  // size and filters, and one offset more than dimensions
  return {{"group.h5", with_own_child('\0', 8)},
          {"chunk.h5", with_own_child('\1', kChunkKey)},
          {"names.h5", with_endless_list()}};
}

TEST(Hdf5Damage, FilesThatTheLibraryFailsOnAreRefused) {
  const TemporaryFolder folder;
  const std::vector<Damaged> files = damaged_files();
  for (const Damaged& file : files) {
    const std::string path = folder / file.name;
    put_file(path, file.bytes);
    const std::string said = file.name + ": the file is damaged";  // or its chunks too large
    expect_refusal<InputError>([&] { (void)h5::open_file(path); }, said);
    if (&file == &files.back()) break;  // the limits end that child, after seconds
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"info", path}, {"validate", path}, {"locate", path, "-o", folder / "beads.csv"}}) {
      const Ran ran = run_program(words);
      EXPECT_EQ(ran.code, 3) << words[0] << " " << file.name << ": " << ran.err;
      EXPECT_NE(ran.err.find(said), std::string::npos) << ran.err;
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "beads.csv"));
  }
}

TEST(Hdf5Damage, ASoundFileIsReadAndReadAgainAfterItChanged) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  put_file(path, sound_file());
  EXPECT_TRUE(h5::open_file(path));
  EXPECT_TRUE(h5::open_file(path));
  put_file(path, damaged_files().front().bytes + std::string(8, '\0'));
  EXPECT_THROW((void)h5::open_file(path), InputError);
  put_file(path, "no HDF5");
  EXPECT_FALSE(h5::open_file(path));
}

TEST(Hdf5Damage, FilesAreOpenedWhileAnotherThreadIsInTheLibrary) {
  hbool_t safe = 0;
  H5is_library_threadsafe(&safe);
  if (!safe) GTEST_SKIP() << "this HDF5 library may be called by one thread only";
  const TemporaryFolder folder;
  put_file(folder / "busy.h5", sound_file());
  const h5::Handle busy = h5::open_file(folder / "busy.h5");
  std::atomic<bool> done{false};
  std::thread other([&] {
    while (!done) (void)h5::exists(busy.get(), "camera/frames");
  });
  for (int k = 0; k < 8; ++k) {
    const std::string path = folder / ("a" + std::to_string(k) + ".h5");
    put_file(path, sound_file());
    EXPECT_TRUE(h5::open_file(path));
  }
  done = true;
  other.join();
}

}  // namespace
}  // namespace twincell::hdf5_damage_test
