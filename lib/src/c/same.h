// The structures of the C interface and those of the library are the same bytes: between them
// nothing is copied but single values.
#pragma once

#include <bit>
#include <cstddef>
#include <span>
#include <type_traits>

#include "base/plain.h"
#include "etcm/c/mesh.h"
#include "etcm/mesh.h"

namespace etcm::c {

using internal::plain;

template <class Ours, class Theirs>
inline constexpr bool is_same_memory =
    sizeof(Ours) == sizeof(Theirs) && std::alignment_of_v<Ours> == std::alignment_of_v<Theirs>;

// A value of one as the same value of the other.
template <class To, class From>
To as(const From& from) noexcept {
  static_assert(is_same_memory<To, From>);
  return std::bit_cast<To>(from);
}

// A list of one as a list of the other.
template <class To, class From>
std::span<To> list(From* first, std::size_t count) noexcept {
  static_assert(is_same_memory<To, From>);
  return {reinterpret_cast<To*>(first), count};
}

// All zero is a Mesh that is not open.
static_assert(is_same_memory<Mesh, etcm_mesh_t>);
inline Mesh& mesh_of(etcm_mesh_t* mesh) noexcept { return *reinterpret_cast<Mesh*>(mesh); }
inline const Mesh& mesh_of(const etcm_mesh_t* mesh) noexcept {
  return *reinterpret_cast<const Mesh*>(mesh);
}

inline etcm_status_t number(Status status) noexcept { return static_cast<etcm_status_t>(status); }

template <class Tag>
constexpr etcm_id_t number(Id<Tag> id) noexcept {
  return id.value;
}

// Not sizeof: of pointers a check of the sources takes that for a slip.
template <class Member>
inline constexpr std::size_t member_size = sizeof(Member);

// Whether a member stands at the same place and is as long.
#define ETCM_SAME_MEMBER(Ours, Theirs, ours, theirs)                                         \
  static_assert(offsetof(Ours, ours) == offsetof(Theirs, theirs) &&                          \
                member_size<decltype(Ours::ours)> == member_size<decltype(Theirs::theirs)>); \
  static_assert(sizeof(Ours) == sizeof(Theirs))

}  // namespace etcm::c
