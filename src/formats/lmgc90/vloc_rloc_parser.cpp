// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_body.hpp"
#include "formats/lmgc90/vloc_rloc.hpp"

#include <sstream>

namespace nscdd {
namespace {

// " RBDY2     11  POLYG      1  CDVER      2  iqsc1  RBDY2      1  POLYG      1 ...": the law stands before the second
// body. The status is after it: slifw, slibw, slide or Wslfw and Wslbw where the contact slides.
void read_pair(const FixedColumns& lines, const Datbox& datbox, DatboxContact& contact) {
  const std::string kind = datbox_body_kind(datbox.dimension), line(lines.line());
  std::vector<std::string> words;
  std::istringstream all(line);
  for (std::string word; all >> word;) words.push_back(word);
  const auto second = std::find(words.begin() + 1, words.end(), kind);
  if (words[0] != kind || second - words.begin() < 5 || words.end() - second < 4)
    lines.refuse(fmt::format("expected two bodies {} with their contactors and a law between them", kind),
                 "'" + line + "'");
  const auto number_of = [](const std::string& word) {  // from 0, below it if there is none
    Index number = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), number);
    return status == std::errc() && *end == '\0' ? number - 1 : -1;
  };
  contact.candidate = number_of(words[1]);
  contact.candidate_shape = number_of(words[3]);
  contact.law = *(second - 1);
  const std::string longer = *(second - 2) + " " + contact.law;  // a name may have a blank
  if (datbox.laws.contains(longer)) contact.law = longer;
  contact.antagonist = number_of(*(second + 1));
  contact.antagonist_shape = number_of(*(second + 3));
  contact.slid = std::any_of(second, words.end(), [](const auto& word) { return word.find("sl") != word.npos; });
  if (std::min({contact.candidate, contact.antagonist, contact.candidate_shape, contact.antagonist_shape}) < 0)
    lines.refuse("expected numbers of bodies and contactors from 1", "'" + line + "'");
  if (contact.within() && contact.candidate < count(datbox.bodies) &&
      datbox.bodies[at(contact.candidate)].contactors.size() == 1)
    lines.refuse("expected two bodies", fmt::format("body {} twice", contact.candidate + 1));
}

// Numbers by their names, which are the five columns before them.
using Numbers = std::map<std::string, double, std::less<>>;

void read_numbers(const FixedColumns& lines, Numbers& numbers) {
  if (!lines.text(1, 29).empty()) return;  // data of laws
  for (const std::size_t first : {35U, 56U, 77U})
    if (const std::string name(lines.text(first - 5, first - 1)); !name.empty())
      numbers[name] = lines.number(first, name);
}

void set_numbers(const Numbers& numbers, bool space, DatboxContact& contact) {
  const auto one = [&](const char* name) {
    if (const auto found = numbers.find(name); found != numbers.end()) return found->second;
    refuse(contact.place, "expected '{}' of the contact, met none", name);
  };
  const auto three = [&](const char* a, const char* b, const char* c) {
    return Vector3(one(a), one(b), space ? one(c) : 0);
  };
  contact.force = three("rln/H", "rlt/H", "rls/H");
  contact.speed = three("vln =", "vlt =", "vls =");
  contact.gap = one(numbers.contains("gTT =") ? "gTT =" : "gapTT");
  contact.point = three("coo1=", "coo2=", "coo3=");
  contact.frame.col(0) = three("n(1)=", "n(2)=", "n(3)=");
  if (space) contact.frame.rightCols(2) << three("t(1)=", "t(2)=", "t(3)="), three("s(1)=", "s(2)=", "s(3)=");
  complete_contact(contact, space);
}

}  // namespace

DatboxNetwork parse_vloc_rloc(std::string_view text, const std::string& name, const Datbox& datbox) {
  FixedColumns lines(text, name);
  DatboxNetwork network{.step = -1};
  for (bool more = lines.next(); more;) {
    if (lines.key() == "$steps") {
      network.step = lines.integer(7, 16, "$steps");
      network.time = lines.number(35, "time");
    }
    if (lines.key() != "$icdan") {
      more = lines.next();
      continue;
    }
    DatboxContact& contact = network.contacts.emplace_back();
    contact.kind = lines.text(9, 13);
    contact.place = lines.place();
    lines.require_next("the names of columns");
    lines.require_next("the two bodies of the contact");
    read_pair(lines, datbox, contact);
    Numbers numbers;
    while ((more = lines.next()) && !lines.section()) read_numbers(lines, numbers);
    set_numbers(numbers, datbox.space(), contact);
  }
  if (network.step < 0 && !network.contacts.empty())
    fail("{}: expected a line $steps with the step and the time, met none", name);
  return network;
}

}  // namespace nscdd
