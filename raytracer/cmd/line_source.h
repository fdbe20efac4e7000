// Standard input in lines, read in big blocks.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "patches/base/result.h"

namespace iso {

struct InputLine {
  std::uint64_t number = 0;  // from 0
  std::string_view text;     // without its end
};

class LineSource {
 public:
  // Up to `most` further lines; none at the end of the input. They stay valid until the next call.
  Status next(std::size_t most, std::vector<InputLine>& lines);

 private:
  Status fill();

  std::string buffer_;
  std::size_t begin_ = 0;  // what is before has been handed out
  std::uint64_t number_ = 0;
  bool end_ = false;
};

}  // namespace iso
