# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference of the public headers: a directive `headers LAYER`, which has every header of a layer with what it
declares, in the order of the file, from the XML of Doxygen ($NSCDD_DOXYGEN_XML)."""
import functools
import glob
import os
import re
import xml.etree.ElementTree as ElementTree

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective

import plain_text

# Part of how parameters and choices are described once, the same in every struct: no news in a reference.
UNINTERESTING = {"fields", "names_of"}
DIRECTIVES = {"function": "function", "variable": "member", "typedef": "type", "enum": "enum"}


def text_of(element):
    return "" if element is None else " ".join("".join(element.itertext()).split())


def description(element):
    """Plain text of a comment: as written where it stands above, else flattened."""
    written = element.find(".//verbatim")
    if written is not None:
        lines = (written.text or "").strip("\n").splitlines()
        return "\n".join(re.sub(r"^\s*/// ?", "", line) for line in lines).strip()
    parts = [text_of(element.find(name)) for name in ("briefdescription", "detaileddescription")]
    return " ".join(part for part in parts if part)


def template_of(element):
    parameters = element.find("templateparamlist")
    if parameters is None:
        return ""
    def one(parameter):
        return " ".join(filter(None, (text_of(parameter.find("type")), text_of(parameter.find("declname")))))
    return f"template<{', '.join(map(one, parameters))}> "


def initial_value(member):
    """Of a variable, where it is short enough to say something."""
    value = text_of(member.find("initializer"))
    return " " + value if re.fullmatch(r"= [-\w.:]+", value) else ""


def signature(member):
    kind, name, kept = member.get("kind"), text_of(member.find("name")), text_of(member.find("type"))
    if kind == "function":
        arguments = re.sub(r"\s*=\s*default$", "", text_of(member.find("argsstring")))
        static = "static " if member.get("static") == "yes" and not kept.startswith("static") else ""
        return f"{template_of(member)}{static}{kept} {name}{arguments}".replace("  ", " ")
    if kind == "typedef":
        return f"{name} = {kept}"
    if kind == "enum":
        return name
    return f"{kept} {name}{text_of(member.find('argsstring'))}{initial_value(member)}"


@functools.cache
def headers_of(folder):
    return Headers(folder)


class Headers:
    """What Doxygen found, by header and line."""

    def __init__(self, folder):
        self.compounds, self.of_file = {}, {}
        for path in sorted(glob.glob(os.path.join(folder, "*.xml"))):
            for compound in ElementTree.parse(path).getroot().iter("compounddef"):
                if compound.get("kind") in ("struct", "class"):
                    self.compounds[compound.get("id")] = compound
                elif compound.get("kind") == "namespace":
                    for member in compound.iter("memberdef"):
                        self.add(member, text_of(compound.find("compoundname")))
        nested = {inner.get("refid") for one in self.compounds.values() for inner in one.findall("innerclass")}
        for key, compound in self.compounds.items():
            name = text_of(compound.find("compoundname"))
            if key not in nested and "<" not in name:  # specialisations are no news
                self.add(compound, name.rpartition("::")[0])

    def add(self, element, namespace):
        place = element.find("location")
        self.of_file.setdefault(place.get("file"), []).append((int(place.get("line")), namespace, element))

    def member(self, member, indent):
        if text_of(member.find("name")) in UNINTERESTING or member.get("kind") not in DIRECTIVES:
            return []
        lines = [f"{indent}.. cpp:{DIRECTIVES[member.get('kind')]}:: {signature(member)}", ""]
        inner = indent + "   "
        lines += [inner + line for line in plain_text.to_rst(description(member))]
        for value in member.findall("enumvalue"):
            lines += [f"{inner}.. cpp:enumerator:: {text_of(value.find('name'))}", ""]
            lines += [f"{inner}   {line}" for line in plain_text.to_rst(description(value))]
        return lines

    def compound(self, compound, indent):
        name = text_of(compound.find("compoundname")).rpartition("::")[2]
        lines = [f"{indent}.. cpp:{compound.get('kind')}:: {template_of(compound)}{name}", ""]
        inner = indent + "   "
        lines += [inner + line for line in plain_text.to_rst(description_of_compound(compound))]
        inside = [(int(member.find("location").get("line")), member) for member in compound.iter("memberdef")
                  if member.get("prot") == "public"]
        for reference in compound.findall("innerclass"):
            if reference.get("prot") == "public" and reference.get("refid") in self.compounds:
                one = self.compounds[reference.get("refid")]
                inside.append((int(one.find("location").get("line")), one))
        for _, element in sorted(inside, key=lambda pair: pair[0]):
            lines += self.compound(element, inner) if element.tag == "compounddef" else self.member(element, inner)
        return lines

    def header(self, path):
        lines = []
        for _, namespace, element in sorted(self.of_file.get(path, []), key=lambda entry: entry[0]):
            lines += [f".. cpp:namespace:: {namespace}", ""]
            lines += self.compound(element, "") if element.tag == "compounddef" else self.member(element, "")
        return lines


def description_of_compound(compound):
    """Its own comment, not the first one of its members."""
    only = ElementTree.Element("compound")
    only.extend(compound.find(name) for name in ("briefdescription", "detaileddescription"))
    return description(only)


class HeadersDirective(SphinxDirective):
    required_arguments = 1

    def run(self):
        config = self.env.config
        found = headers_of(config.doxygen_xml)
        layer = self.arguments[0]
        sections = []
        below = os.path.join(config.include_folder, "nscdd", layer, "**", "*.hpp")
        for path in sorted(glob.glob(below, recursive=True)):
            name = os.path.relpath(path, config.include_folder)
            section = nodes.section(ids=[nodes.make_id(name)])
            section += nodes.title("", "", nodes.literal(text=f"<{name}>"))
            self.env.note_dependency(path)
            self.state.nested_parse(StringList(found.header(name), source=path), 0, section)
            sections.append(section)
        if not sections:
            raise self.error(f"no public header in the layer '{layer}'")
        return sections


def setup(app):
    app.add_config_value("doxygen_xml", "", "env")
    app.add_config_value("include_folder", "", "env")
    app.add_directive("headers", HeadersDirective)
    return {"parallel_read_safe": True}
