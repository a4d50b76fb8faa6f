// The calls that give a mesh its memory, or take one that lies in memory.
#include <algorithm>
#include <memory>

#include "answer_calls.h"
#include "answer_states.h"
#include "etcm/storage.h"

namespace etcm::test {
namespace {

using enum Status;

// Configurations that no mesh can have.
std::vector<MeshConfig> bad_configs(const MeshConfig& good) {
  std::vector<MeshConfig> all(5, good);
  all[0].vertices_max = 0;
  all[1].vertices_max = vertices_limit + 1;
  all[2].vertices_max = ~0u;
  all[3].features_max = features_limit + 1;
  all[4].policy = nullptr;
  return all;
}

std::vector<Question> validations(const Mesh& mesh) {
  std::vector<Question> all;
  std::vector<MeshConfig> configs = bad_configs(mesh.config());
  configs.push_back(mesh.config());
  for (const MeshConfig& config : configs) {
    all.push_back({[config](Mesh&, Work) { return validate(config); }});
  }
  return all;
}

bool is_empty(const Mesh& mesh) {
  return mesh.node_count() == 0 && mesh.steiner_count() == 0 && mesh.feature_count() == 0 &&
         mesh.unresolved() == 0 && mesh.triangle_count() == 0;
}

// In other memory, where something else was; and in that which it has.
std::vector<Question> openings(const Mesh& mesh) {
  std::vector<Question> all;
  const auto add = [&all](const MeshConfig& config, std::size_t size) {
    all.push_back({[=](Mesh& m, Work) {
      static std::vector<std::uint64_t> kept;
      kept.assign(size / 8 + 1, 0xa5a5'a5a5'a5a5'a5a5u);
      const Status status = m.open(std::as_writable_bytes(std::span(kept)).first(size), config);
      EXPECT_TRUE(status != ok || is_empty(m));
      return status;
    }});
  };
  const MeshConfig good = mesh.config();
  const std::size_t bytes = storage_bytes(good);
  for (const std::size_t size : {std::size_t{0}, bytes - 1, bytes, bytes + 9}) add(good, size);
  for (const MeshConfig& bad : bad_configs(good)) add(bad, bytes);
  all.push_back({.ask_of_bytes = [good](MeshBlock& block) {
    const Status status = block->open(block.bytes(), good);
    EXPECT_TRUE(is_empty(*block));
    return status;
  }});
  return all;
}

// Of mesh bytes that were altered: the byte, and what it is changed with.
struct Harm {
  std::size_t at;
  unsigned char bits;
};

// Bytes of a mesh, and what became of them.
struct Fate {
  std::function<void(MeshBlock&)> harm = [](MeshBlock&) {};
  std::size_t cut = ~std::size_t{0};
  std::span<std::byte> meet(MeshBlock& block) const {
    harm(block);
    return block.bytes().first(std::min(cut, block.bytes().size()));
  }
};

std::vector<Fate> fates() {
  std::vector<Fate> all{{}, {.cut = 800}, {.cut = 8}};
  for (const Harm harm :
       {Harm{0, 1}, Harm{seal_version, 0xff}, Harm{seal_id_bits, 0x70}, Harm{seal_bytes, 1}}) {
    all.push_back({[harm](MeshBlock& block) {
      block.in_seal(harm.at) ^= static_cast<std::byte>(harm.bits);
    }});
  }
  all.push_back({[](MeshBlock& block) { std::reverse(&block.in_seal(0), &block.in_seal(0) + 8); }});
  return all;
}

std::unique_ptr<MeshBlock> another_mesh() {
  const MeshConfig config{.vertices_max = 40, .features_max = 20};
  auto block = std::make_unique<MeshBlock>(config);
  EXPECT_EQ((*block)->open(block->bytes(), config), ok);
  EXPECT_EQ((*block)->build(crossing_lines().nodes, crossing_lines().features), ok);
  return block;
}

// Takes its own bytes from another place, or those of another mesh.
std::vector<Question> attachments(bool is_copy) {
  std::vector<Question> all;
  const auto add = [&](const Fate& fate, bool is_own, SplitPolicy policy = split_default) {
    all.push_back({.ask_of_bytes = [=](MeshBlock& block) {
      std::unique_ptr<MeshBlock> other = another_mesh();
      Mesh& source = is_own ? *block : **other;
      const Picture expected = picture_of(source);
      if (!is_copy) seal(source);
      static std::unique_ptr<MeshBlock> kept;
      kept = std::make_unique<MeshBlock>(is_own ? block : *other);
      const std::span<std::byte> bytes = fate.meet(*kept);
      const Status status =
          is_copy ? attach_copy(*block, bytes, policy) : attach(*block, bytes, policy);
      EXPECT_TRUE(status != ok || picture_of(*block) == expected);
      return status;
    }});
  };
  for (const bool is_own : {false, true}) {
    for (const Fate& fate : fates()) add(fate, is_own);
    add({}, is_own, nullptr);
  }
  return all;
}

// Reads a mesh in the state; what was refused leaves the reader the mesh it had.
std::vector<Question> readings(bool is_copy) {
  std::vector<Question> all;
  for (const Fate& fate : fates()) {
    all.push_back({.ask_of_bytes = [=](MeshBlock& block) {
      if (!is_copy) seal(*block);
      MeshBlock bytes(block);
      const std::unique_ptr<MeshBlock> before = another_mesh();
      MeshReader reader;
      EXPECT_EQ(reader.attach_copy(before->bytes()), ok);
      const std::span<const std::byte> met = fate.meet(bytes);
      const Status status = is_copy ? reader.attach_copy(met) : reader.attach(met);
      EXPECT_TRUE(picture_of(reader.mesh()) == picture_of(status == ok ? *block : **before));
      return status;
    }});
  }
  return all;
}

}  // namespace

std::vector<MeshCall> calls_of_memory() {
  const Refused nothing = Refused::changes_nothing;
  const std::set<Status> of_bytes{
      ok, wrong_byte_order, not_a_mesh, wrong_version, wrong_id_width, storage_too_small, damaged};
  const std::set<Status> of_attachment = with(of_bytes, {bad_config});
  return {
      {"validate", {ok, bad_config}, nothing, false, false, validations},
      {"open", {ok, bad_config, storage_too_small}, nothing, false, false, openings},
      {"attach", of_attachment, nothing, false, false,
       [](const Mesh&) { return attachments(false); }},
      {"attach_copy", of_attachment, nothing, false, false,
       [](const Mesh&) { return attachments(true); }},
      {"MeshReader::attach", of_bytes, nothing, false, false,
       [](const Mesh&) { return readings(false); }},
      {"MeshReader::attach_copy", of_bytes, nothing, false, false,
       [](const Mesh&) { return readings(true); }},
  };
}

}  // namespace etcm::test
