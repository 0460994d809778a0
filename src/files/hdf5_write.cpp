// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_types.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace nscdd::hdf5 {
namespace {

Handle text_type(std::size_t length, H5T_str_t padding = H5T_STR_NULLPAD) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, padding);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

// Texts of equal length, filled up with zeros.
std::string padded(std::span<const std::string> texts, std::size_t length) {
  std::string bytes;
  for (const std::string& text : texts) {
    bytes.append(text, 0, length);
    bytes.append(length - std::min(length, text.size()), '\0');
  }
  return bytes;
}

Handle scalar_space() { return Handle(H5Screate(H5S_SCALAR), H5Sclose); }

Handle new_dataset(const Group& group, const std::string& name, hid_t type, hsize_t extent, Chunk chunk,
                   Attributes attributes) {
  const Handle properties = without_times(H5P_DATASET_CREATE);
  const hsize_t unlimited = H5S_UNLIMITED, size = static_cast<hsize_t>(chunk);
  if (chunk > 0) require(H5Pset_chunk(properties, 1, &size));
  const Handle space(H5Screate_simple(1, &extent, chunk > 0 ? &unlimited : nullptr), H5Sclose);
  Handle dataset(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                 fmt::format("{}: cannot be made", group.of(name)));
  for (const auto& [key, text] : attributes) {
    const Handle text_of = text_type(text.size());
    const Handle attribute(H5Acreate2(dataset, key, text_of, scalar_space(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    require(H5Awrite(attribute, text_of, text.empty() ? "" : text.data()));
  }
  return dataset;
}

Handle open_dataset(const Group& group, const std::string& name) {
  return Handle(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose,
                fmt::format("{}: cannot be opened", group.of(name)));
}

}  // namespace

template <class Value>
void Group::put(const std::string& name, std::span<const Value> values, Attributes attributes, Chunk chunk) const {
  const Types types = types_of<Value>();
  const hsize_t extent = values.size();
  const bool there = has(name);
  const Handle dataset =
      there ? open_dataset(*this, name) : new_dataset(*this, name, types.file, extent, chunk, attributes);
  const std::string failure = fmt::format("{}: cannot be written", of(name));
  if (there && chunk > 0) require(H5Dset_extent(dataset, &extent), failure);
  if (extent == 0) return;
  const Handle space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
  require(H5Dwrite(dataset, types.memory, space, H5S_ALL, H5P_DEFAULT, values.data()), failure);
}

void Group::put_texts(const std::string& name, std::span<const std::string> texts, Attributes attributes) const {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  const Handle type = text_type(length);
  const Handle dataset = new_dataset(*this, name, type, texts.size(), 0, attributes);
  if (texts.empty()) return;
  require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded(texts, length).data()));
}

void Group::append_bytes(const std::string& name, hid_t file_type, hid_t memory_type, std::size_t size,
                         const void* data, Attributes attributes, Chunk chunk) const {
  if (size == 0) return;
  const Handle dataset =
      has(name) ? open_dataset(*this, name) : new_dataset(*this, name, file_type, 0, chunk, attributes);
  const std::string failure = fmt::format("{}: cannot be written", of(name));
  hsize_t extent = 0;
  const Handle before(H5Dget_space(dataset), H5Sclose, failure);
  H5Sget_simple_extent_dims(before, &extent, nullptr);
  const hsize_t more = size, longer = extent + more;
  require(H5Dset_extent(dataset, &longer), failure);
  const Handle target(H5Dget_space(dataset), H5Sclose, failure);
  require(H5Sselect_hyperslab(target, H5S_SELECT_SET, &extent, nullptr, &more, nullptr), failure);
  const Handle source(H5Screate_simple(1, &more, nullptr), H5Sclose);
  require(H5Dwrite(dataset, memory_type, source, target, H5P_DEFAULT, data), failure);
}

template <class Value>
void Group::append(const std::string& name, std::span<const Value> values, Attributes attributes, Chunk chunk) const {
  const Types types = types_of<Value>();
  append_bytes(name, types.file, types.memory, values.size(), values.data(), attributes, chunk);
}

void Group::append_texts(const std::string& name, std::span<const std::string> texts, std::size_t longest,
                         Attributes attributes, Chunk chunk) const {
  const Handle type = text_type(longest);
  append_bytes(name, type, type, texts.size(), padded(texts, longest).data(), attributes, chunk);
}

// A dataset holds a text of any length; an attribute holds 64 KiB at the most.
void Group::put_text_bytes(const std::string& name, hid_t type, const std::string& bytes) const {
  const Handle dataset(
      H5Dcreate2(id_, name.c_str(), type, scalar_space(), H5P_DEFAULT, without_times(H5P_DATASET_CREATE), H5P_DEFAULT),
      H5Dclose, fmt::format("{}: cannot be made", of(name)));
  require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()),
          fmt::format("{}: cannot be written", of(name)));
}

void Group::put_text(const std::string& name, const std::string& text) const {
  put_text_bytes(name, text_type(text.size()), text);
}

void Group::put_terminated_text(const std::string& name, const std::string& text) const {
  put_text_bytes(name, text_type(text.size() + 1, H5T_STR_NULLTERM), text);
}

void Group::put_attribute(const std::string& name, std::string_view text) const {
  if (H5Aexists(id_, name.c_str()) > 0) H5Adelete(id_, name.c_str());
  const Handle type = text_type(text.size());
  const Handle attribute(H5Acreate2(id_, name.c_str(), type, scalar_space(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(H5Awrite(attribute, type, text.empty() ? "" : text.data()));
}

void Group::put_attribute(const std::string& name, double value) const {
  if (H5Aexists(id_, name.c_str()) > 0) H5Adelete(id_, name.c_str());
  const Handle attribute(H5Acreate2(id_, name.c_str(), H5T_IEEE_F64LE, scalar_space(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  require(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value));
}

template void Group::put(const std::string&, std::span<const double>, Attributes, Chunk) const;
template void Group::put(const std::string&, std::span<const std::int64_t>, Attributes, Chunk) const;
template void Group::put(const std::string&, std::span<const std::int32_t>, Attributes, Chunk) const;
template void Group::put(const std::string&, std::span<const std::int8_t>, Attributes, Chunk) const;
template void Group::append(const std::string&, std::span<const double>, Attributes, Chunk) const;
template void Group::append(const std::string&, std::span<const std::int64_t>, Attributes, Chunk) const;

}  // namespace nscdd::hdf5
