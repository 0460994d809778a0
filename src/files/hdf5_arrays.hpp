// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/hdf5_handles.hpp"
#include <nscdd/core/types.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// Arrays, texts and groups of HDF5 files that grow. Every function throws Error naming the object.
namespace nscdd {

using hdf5::Handle;

/// Errors are thrown, not printed, and nothing is tried again at the end of the program: what cannot be
/// written to a full disk would crash it there.
void prepare_hdf5();

/// Opens a file for reading, or for changing. Throws Error `failure`.
Handle open_hdf5(const std::string& path, bool change, const std::string& failure);

Handle open_or_make_group(hid_t parent, const std::string& name);
Handle member_group(hid_t parent, const std::string& name, const std::string& file);
bool has_link(hid_t parent, const std::string& name);

/// How an array lies in its file: 0 for one of fixed size, else elements per chunk of one that may change its
/// size.
using Chunk = Index;

/// Writes an array; one of that name is overwritten, in another size where it has chunks.
template <class Value>
void put_array(hid_t group, const std::string& name, std::span<const Value> values, const std::string& unit,
               Chunk chunk = 0);

/// Writes behind the end of an array with chunks, which begins empty where there is none.
template <class Value>
void append_to_array(hid_t group, const std::string& name, const Value& value, const std::string& unit,
                     const std::string& description, Chunk chunk);
void append_to_texts(hid_t group, const std::string& name, const std::string& text, std::size_t longest,
                     const std::string& description, Chunk chunk);

template <class Value>
std::vector<Value> get_array(hid_t group, const std::string& name, const std::string& file);

void put_text(hid_t group, const std::string& name, const std::string& text);
std::string get_text(hid_t group, const std::string& name, const std::string& file);
void put_attribute(hid_t object, const std::string& name, const std::string& text);
void put_attribute(hid_t object, const std::string& name, double value);
std::string get_text_attribute(hid_t object, const std::string& name, const std::string& file);
double get_number(hid_t object, const std::string& name, const std::string& file);

}  // namespace nscdd
