// What depends on a key alone and takes long to make: made once per key, kept while the program runs. Safe from all threads.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace iso {

template <class Key, class Value>
class MadeOnce {
 public:
  // make(): Value. Who asks meanwhile waits.
  template <class Make>
  std::shared_ptr<const Value> of(const Key& key, const Make& make) {
    const std::lock_guard lock(mutex_);
    for (const auto& [of, value] : made_)
      if (of == key) return value;
    return made_.emplace_back(key, std::make_shared<const Value>(make())).second;
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<Key, std::shared_ptr<const Value>>> made_;
};

}  // namespace iso
