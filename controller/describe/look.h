#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "controller/describe/describe.h"

namespace moma::description {

/// Common part of visitors that only inspect a struct: dotted keys, recursion into inlined parts, groups, and members
/// that are not always written. `Self` has below(key), itself at another key of the same struct, and descend(key,
/// part), itself on a part.
template <class Self, class T>
class Look {
 public:
  template <class P>
  void inlined(P pointer) {
    self().descend(prefix_, value_.*pointer);
  }
  template <class Body>
  void group(std::string_view name, std::string_view, Body body) {
    Self inner = self().below(key_of(name));
    body(inner);
  }
  template <class Holds, class Body>
  void written_where(Holds, Body body) {
    body(self());
  }

 protected:
  Look(const T& value, std::string prefix) : value_(value), prefix_(std::move(prefix)) {}

  std::string key_of(std::string_view name) const {
    return prefix_.empty() ? std::string(name) : prefix_ + "." + std::string(name);
  }

  const T& value_;
  std::string prefix_;

 private:
  Self& self() { return static_cast<Self&>(*this); }
};

}  // namespace moma::description
