#include "triangulation/free_ids.h"

#include <utility>

namespace etcm::internal {
namespace {

constexpr IdValue none = VertexId::none_value;

// A record is something else while its id is in use.
using Word [[gnu::may_alias]] = IdValue;
struct [[gnu::may_alias]] Node {
  Word left;
  Word right;
  Word count;  // of the heap from here on
};

Node& at(FreeRecords records, IdValue id) noexcept {
  return *reinterpret_cast<Node*>(records.first + id * records.stride);
}

// Of the two roots the lesser one stays, and what is below its right side is merged on with the
// other heap. How many ids that makes is known before, so the sides are exchanged on the way down.
IdValue merge(FreeRecords records, IdValue a, IdValue b) noexcept {
  Word root = none;
  Word* slot = &root;
  while (a != none && b != none) {
    if (b < a) std::swap(a, b);
    *slot = a;
    Node& node = at(records, a);
    node.count = static_cast<IdValue>(node.count + at(records, b).count);
    const IdValue left = node.left;
    const IdValue left_count = left == none ? IdValue{0} : at(records, left).count;
    a = node.right;
    if (2u * left_count + 1u < node.count) {
      node.right = left;
      slot = &node.left;
    } else {
      slot = &node.right;
    }
  }
  *slot = a == none ? b : a;
  return root;
}

}  // namespace

IdValue FreeIds::count(FreeRecords records) const noexcept {
  return is_empty() ? IdValue{0} : at(records, least_).count;
}

void FreeIds::add(FreeRecords records, IdValue id) noexcept {
  at(records, id) = {none, none, 1};
  least_ = merge(records, least_, id);
}

IdValue FreeIds::take(FreeRecords records) noexcept {
  const IdValue id = least_;
  least_ = merge(records, at(records, id).left, at(records, id).right);
  return id;
}

void FreeIds::keep_below(FreeRecords records, IdValue end) noexcept {
  FreeIds kept;
  while (!is_empty()) {
    const IdValue id = take(records);
    if (id < end) kept.add(records, id);
  }
  *this = kept;
}

}  // namespace etcm::internal
