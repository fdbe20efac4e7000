#include "patches/io/gltf_data.h"

#include <fmt/format.h>

#include <bit>
#include <filesystem>
#include <optional>

#include "patches/io/mesh_input.h"

namespace iso {

static_assert(std::endian::native == std::endian::little, "buffers are read as numbers lie in memory");

namespace {

constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr std::string_view kMagic = "glTF";

// "a%20b" to "a b".
std::string without_escapes(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    int code = 0;
    const std::string_view digits = uri.substr(i + 1, 2);
    const bool escaped =
        uri[i] == '%' && digits.size() == 2 && std::from_chars(digits.data(), digits.data() + 2, code, 16).ptr == digits.data() + 2;
    text += escaped ? static_cast<char>(code) : uri[i];
    if (escaped) i += 2;
  }
  return text;
}

std::optional<std::string> from_base64(std::string_view text) {
  static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> value;
  value.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i) value[static_cast<unsigned char>(kDigits[i])] = static_cast<int>(i);
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() * 3 / 4);
  unsigned collected = 0;
  int bits = 0;
  for (const char c : text) {
    const int digit = value[static_cast<unsigned char>(c)];
    if (digit < 0) return std::nullopt;
    collected = (collected << 6 | static_cast<unsigned>(digit)) & 0xFFFF;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(collected >> bits & 0xFF);
  }
  return bytes;
}

}  // namespace

struct GltfData::Component {
  std::uint64_t type = 0;
  std::size_t bytes = 0;
  double largest = 0;  // of integers

  double value(std::string_view at) const {
    switch (type) {
      case 5120:
        return number_at<std::int8_t>(at, 0);
      case 5121:
        return number_at<std::uint8_t>(at, 0);
      case 5122:
        return number_at<std::int16_t>(at, 0);
      case 5123:
        return number_at<std::uint16_t>(at, 0);
      case 5125:
        return number_at<std::uint32_t>(at, 0);
      case 5126:
        return static_cast<double>(number_at<float>(at, 0));
    }
    ISO_CHECK(false);
  }
};

GltfData::GltfData(const std::string& path, std::string_view content) : path_(path) {
  if (content.substr(0, kMagic.size()) == kMagic)
    parse(chunks(content), 20);
  else
    parse(content, 0);
  const JsonValue version = root().at("asset").at("version");
  if (version.text().substr(0, 2) != "2.") version.fail(iso::quoted(version.text()), "version 2.0");
  read_buffers();
}

// The chunk of JSON; sets that of numbers.
std::string_view GltfData::chunks(std::string_view content) {
  const auto word = [&](std::size_t at) {
    if (content.size() - at < 4) fail_at_byte(path_, content.size(), "found the end of the file, expected the head of a chunk");
    return number_at<std::uint32_t>(content, at);
  };
  if (content.size() < 12) fail_at_byte(path_, content.size(), "found the end of the file, expected 12 bytes before the chunks");
  if (word(4) != 2) fail_at_byte(path_, 4, fmt::format("found version {} of glTF, expected 2", word(4)));
  if (word(8) > content.size()) fail_at_byte(path_, content.size(), fmt::format("found the end of the file, expected {} bytes", word(8)));
  content = content.substr(0, std::max<std::size_t>(word(8), 12));

  std::string_view json;
  for (std::size_t at = 12, number = 0; at < content.size(); ++number) {
    const std::uint32_t length = word(at), type = word(std::min(at + 4, content.size()));
    if (length > content.size() - at - 8)
      fail_at_byte(path_, at, fmt::format("found a chunk of {} bytes, expected at most {}", length, content.size() - at - 8));
    if (number == 0 && type != kJsonChunk) fail_at_byte(path_, at + 4, "found another chunk, expected JSON first");
    if (number == 0) json = content.substr(at + 8, length);
    if (number > 0 && type == kBinaryChunk && binary_.empty()) binary_ = content.substr(at + 8, length);
    at += 8 + std::size_t{length};
  }
  return json;
}

void GltfData::parse(std::string_view text, std::size_t bytes_before) {
  try {
    json_ = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    fail_at_byte(path_, bytes_before + e.byte, told(e) + "; expected JSON");
  } catch (const nlohmann::json::exception& e) {
    fail_at_byte(path_, bytes_before, told(e) + "; expected JSON");
  }
}

void GltfData::read_buffers() {
  if (!root().has("buffers")) return;
  const JsonValue list = root().at("buffers");
  owned_.reserve(list.size());  // so that what buffers_ looks at stays where it is
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string_view bytes = buffer(list.at(i), i);
    const JsonValue length = list.at(i).at("byteLength");
    if (length.whole() > bytes.size())
      length.fail(fmt::format("{}", length.whole()), fmt::format("at most the {} bytes that there are", bytes.size()));
    buffers_.push_back(bytes.substr(0, length.whole()));
    bytes_ += length.whole();
  }
}

std::string_view GltfData::buffer(const JsonValue& value, std::size_t i) {
  if (!value.has("uri")) {
    if (i > 0 || binary_.empty()) value.fail("no uri", "one, or a chunk of numbers in the file");
    return binary_;
  }
  const JsonValue uri = value.at("uri");
  const std::string text = uri.text();
  if (text.starts_with("data:")) {
    const std::size_t comma = text.find(',');
    const bool is_base64 = comma != text.npos && std::string_view(text).substr(0, comma).ends_with(";base64");
    auto bytes = is_base64 ? from_base64(std::string_view(text).substr(comma + 1)) : std::nullopt;
    if (!bytes) uri.fail(iso::quoted(text), "data in base64");
    return owned_.emplace_back(std::move(*bytes));
  }
  if (text.find("://") != text.npos) uri.fail(iso::quoted(text), "a file");

  // Reading devices might never end.
  const auto file = std::filesystem::path(path_).parent_path() / without_escapes(text);
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored) && !std::filesystem::is_regular_file(file, ignored))
    uri.fail(iso::quoted(text), "a regular file");
  auto bytes = read_text(file.string());
  if (!bytes) throw bytes.error();
  return owned_.emplace_back(std::move(*bytes));
}

JsonValue GltfData::refer(const JsonValue& index, const char* list) const {
  const std::size_t count = root().has(list) ? root().at(list).size() : 0;
  if (index.whole() >= count) index.fail(fmt::format("{}", index.whole()), fmt::format("the index of one of {} {}", count, list));
  return root().at(list).at(index.whole());
}

GltfData::Component GltfData::component(const JsonValue& holder) const {
  static constexpr std::pair<std::size_t, double> kKinds[] = {{1, 127}, {1, 255},          {2, 32767}, {2, 65535},
                                                              {0, 0},   {4, 4294967295.0}, {4, 0}};
  constexpr std::uint64_t kFirst = 5120;
  const JsonValue type = holder.at("componentType");
  const std::uint64_t kind = type.whole() - kFirst;  // what is too small becomes large
  if (kind >= std::size(kKinds) || kKinds[kind].first == 0)
    type.fail(fmt::format("{}", type.whole()), "5120, 5121, 5122, 5123, 5125 or 5126");
  return {type.whole(), kKinds[kind].first, kKinds[kind].second};
}

// Calls put(i, bytes) for the elements in the buffer view of an accessor, or of one of the two lists of a sparse one, all checked to lie
// within it.
template <class Put>
void GltfData::for_each_element(const JsonValue& holder, std::uint64_t count, std::size_t bytes, Put put) const {
  const JsonValue view = refer(holder.at("bufferView"), "bufferViews");
  const JsonValue index = view.at("buffer");
  if (index.whole() >= buffers_.size())
    index.fail(fmt::format("{}", index.whole()), fmt::format("the index of one of {} buffers", buffers_.size()));
  const std::string_view buffer = buffers_[index.whole()];
  const std::uint64_t begin = view.whole_or("byteOffset", 0), length = view.at("byteLength").whole();
  if (begin > buffer.size() || length > buffer.size() - begin)
    view.fail(fmt::format("the bytes from {} to {}", begin, begin + length), fmt::format("a part of a buffer of {}", buffer.size()));

  const std::uint64_t stride = view.whole_or("byteStride", bytes), offset = holder.whole_or("byteOffset", 0);
  if (stride < bytes || stride > 255) view.fail(fmt::format("the stride {}", stride), fmt::format("{} to 252", bytes));
  if (count > length || (count > 0 && offset + (count - 1) * stride + bytes > length))
    holder.fail(fmt::format("{} elements from byte {} on, {} apart", count, offset, stride),
                fmt::format("such that end in a buffer view of {} bytes", length));
  for (std::uint64_t i = 0; i < count; ++i) put(i, buffer.substr(begin + offset + i * stride, bytes));
}

GltfNumbers GltfData::numbers(const JsonValue& accessor, const std::string& type) const {
  const JsonValue a = refer(accessor, "accessors");
  if (a.at("type").text() != type) a.at("type").fail(iso::quoted(a.at("type").text()), type);
  const std::size_t components = type == "VEC3" ? 3 : 1;
  const Component c = component(a);
  const std::uint64_t count = a.at("count").whole();
  const bool normalized = a.has("normalized") && a.at("normalized").is_true() && c.largest > 0;
  GltfNumbers result{{}, c.largest == 0, normalized ? 1 / c.largest : 1};
  const auto put = [&](std::uint64_t i, std::string_view bytes) {
    for (std::size_t k = 0; k < components; ++k) {
      const double value = c.value(bytes.substr(k * c.bytes)) * result.step;
      result.values[components * i + k] = normalized ? std::max(value, -1.0) : value;
    }
  };

  // Without a view all are 0 at first; more of them than the file has bytes are damage.
  if (count > bytes_) a.at("count").fail(fmt::format("{}", count), fmt::format("no more than the buffers' {} bytes", bytes_));
  result.values.resize(components * count);
  if (a.has("bufferView")) for_each_element(a, count, components * c.bytes, put);
  if (!a.has("sparse")) return result;
  const JsonValue sparse = a.at("sparse");
  const std::vector<std::uint64_t> places = sparse_places(sparse, count);
  for_each_element(sparse.at("values"), places.size(), components * c.bytes,
                   [&](std::uint64_t i, std::string_view bytes) { put(places[i], bytes); });
  return result;
}

// Which elements of `count` a sparse accessor replaces.
std::vector<std::uint64_t> GltfData::sparse_places(const JsonValue& sparse, std::uint64_t count) const {
  const JsonValue indices = sparse.at("indices");
  const Component c = component(indices);
  std::vector<std::uint64_t> places;
  for_each_element(indices, sparse.at("count").whole(), c.bytes, [&](std::uint64_t, std::string_view bytes) {
    const double i = c.value(bytes);
    if (!(i >= 0 && i < static_cast<double>(count) && i == std::floor(i)))
      indices.fail(fmt::format("{}", i), fmt::format("an index under {}", count));
    places.push_back(static_cast<std::uint64_t>(i));
  });
  return places;
}

}  // namespace iso
