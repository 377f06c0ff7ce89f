// SPDX-License-Identifier: MIT
// FBX files made by tests, the same one as text and as bytes.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace genrender::tests {

/// A record with its properties and what is within.
struct fbx_tree {
    using property = std::variant<std::string, std::int32_t, std::int64_t, double, std::vector<std::int32_t>,
                                  std::vector<std::int64_t>, std::vector<float>, std::vector<double>>;

    std::string name;
    std::vector<property> properties{};
    std::vector<fbx_tree> within{};

    /// As text; `Class::name` is how names are written there.
    std::string text() const {
        std::string result = name + ": ";
        for (std::size_t i = 0; i < properties.size(); ++i) {
            result += i > 0 ? ", " : "";
            std::visit([&](auto const& value) { result += text_of(value); }, properties[i]);
        }
        if (!within.empty()) {
            result += " {\n";
            for (auto const& one : within) {
                result += one.text();
            }
            result += "}";
        }
        return result + "\n";
    }

    /// As bytes that stand at `begin` of the file, whose words have `width` bytes.
    std::string bytes(std::size_t begin, std::size_t width, bool is_packed) const {
        std::string values;
        for (auto const& one : properties) {
            std::visit([&](auto const& value) { values += bytes_of(value, is_packed); }, one);
        }
        auto result = std::string(3 * width, '\0') + static_cast<char>(name.size()) + name + values;
        for (auto const& one : within) {
            result += one.bytes(begin + result.size(), width, is_packed);
        }
        result += within.empty() ? std::string() : std::string(3 * width + 1, '\0');
        std::uint64_t const words[3]{begin + result.size(), properties.size(), values.size()};
        for (std::size_t i = 0; i < 3; ++i) {
            std::memcpy(result.data() + i * width, &words[i], width);
        }
        return result;
    }

private:
    static std::string text_of(std::string const& value) { return '"' + value + '"'; }
    template <class Number>
    static std::string text_of(Number value) {
        return std::to_string(value);
    }
    template <class Number>
    static std::string text_of(std::vector<Number> const& values) {
        auto result = "*" + std::to_string(values.size()) + " {\na: ";
        for (std::size_t i = 0; i < values.size(); ++i) {
            // The third of four data of a key are bits, written as a whole number
            std::uint32_t bits = 0;
            if constexpr (std::is_same_v<Number, float>) {
                std::memcpy(&bits, &values[i], sizeof bits);
            }
            auto const is_bits = i % 4 == 2 && values.size() % 4 == 0 && std::is_same_v<Number, float>;
            result += (i > 0 ? "," : "") + (is_bits ? std::to_string(bits) : std::to_string(values[i]));
        }
        return result + "\n}";
    }

    template <class Number>
    static std::string raw(Number const* values, std::size_t count) {
        return {reinterpret_cast<char const*>(values), count * sizeof(Number)};
    }
    static std::string bytes_of(std::string value, bool) {
        if (auto const at = value.find("::"); at != value.npos) {
            value = value.substr(at + 2) + std::string("\0\1", 2) + value.substr(0, at);
        }
        auto const size = static_cast<std::uint32_t>(value.size());
        return "S" + raw(&size, 1) + value;
    }
    template <class Number>
    static char letter() {
        return std::is_same_v<Number, std::int32_t>   ? 'i'
               : std::is_same_v<Number, std::int64_t> ? 'l'
               : std::is_same_v<Number, float>        ? 'f'
                                                      : 'd';
    }
    template <class Number>
    static std::string bytes_of(Number value, bool) {
        return static_cast<char>(letter<Number>() - 'a' + 'A') + raw(&value, 1);
    }
    template <class Number>
    static std::string bytes_of(std::vector<Number> const& values, bool is_packed) {
        auto data = raw(values.data(), values.size());
        if (is_packed) {
            std::string packed(compressBound(data.size()), '\0');
            auto size = static_cast<uLongf>(packed.size());
            compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<Bytef const*>(data.data()),
                     data.size());
            data = packed.substr(0, size);
        }
        std::uint32_t const head[3]{static_cast<std::uint32_t>(values.size()), is_packed,
                                    static_cast<std::uint32_t>(data.size())};
        return letter<Number>() + raw(head, 3) + data;
    }
};

/// A triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) whose x follows a curve of these keys, FBX's ticks, with a run of
/// attributes for each key.
struct fbx_motion {
    std::vector<std::int64_t> times;
    std::vector<float> values;
    std::vector<std::int32_t> flags;
    std::vector<float> data; ///< four a key
    std::string take = "Take";
    std::vector<fbx_motion> more{}; ///< further takes of the file
    bool is_turned = false; ///< by a quarter around z before its own rotation, and at (5, 6, 7) without the motion

    std::vector<fbx_tree> records(std::int32_t version) const {
        using doubles = std::vector<double>;
        using whole = std::vector<std::int32_t>;
        auto const id = [](std::int64_t number) { return fbx_tree::property(number); };
        auto const link = [&](char const* kind, std::int64_t from, std::int64_t to) {
            return fbx_tree{"C", {std::string(kind), id(from), id(to)}, {}};
        };
        auto const to_property = [&](std::int64_t from, std::int64_t to, char const* property) {
            auto made = link("OP", from, to);
            made.properties.emplace_back(std::string(property));
            return made;
        };
        auto const object = [&](char const* type, std::int64_t number, char const* name, char const* kind,
                                std::vector<fbx_tree> within) {
            return fbx_tree{type, {id(number), std::string(name), std::string(kind)}, std::move(within)};
        };
        auto const vector = [](char const* name, char const* type, double x, double y, double z) {
            return fbx_tree{"P", {std::string(name), std::string(type), std::string(), std::string("A"), x, y, z}, {}};
        };
        auto const rate = fbx_tree{
            "P", {std::string("TimeMode"), std::string("enum"), std::string(), std::string(), std::int32_t{11}}, {}};
        std::vector<fbx_tree> model{{"Version", {std::int32_t{232}}, {}}};
        if (is_turned) {
            model.push_back(
                {"Properties70",
                 {},
                 {vector("PreRotation", "Vector3D", 0, 0, 90), vector("Lcl Translation", "Lcl Translation", 5, 6, 7)}});
        }
        std::vector<fbx_tree> objects{object("Geometry", 2, "Geometry::thing", "Mesh",
                                             {{"Vertices", {doubles{0, 0, 0, 1, 0, 0, 0, 1, 0}}, {}},
                                              {"PolygonVertexIndex", {whole{0, 1, -3}}, {}}}),
                                      object("Model", 1, "Model::thing", "Mesh", model)};
        std::vector<fbx_tree> links{link("OO", 1, 0), link("OO", 2, 1)};
        std::int64_t first = 10;
        auto const add = [&](fbx_motion const& motion) {
            objects.push_back(
                object("AnimationStack", first, ("AnimStack::" + motion.take).c_str(), "", {{"Properties70", {}, {}}}));
            objects.push_back(object("AnimationLayer", first + 1, "AnimLayer::Layer", "", {{"Properties70", {}, {}}}));
            // Where the take moves nothing the properties of its node hold
            objects.push_back(
                object("AnimationCurveNode", first + 2, "AnimCurveNode::T", "",
                       {{"Properties70",
                         {},
                         {number_property("d|X", is_turned ? 5 : 0), number_property("d|Y", is_turned ? 6 : 0),
                          number_property("d|Z", is_turned ? 7 : 0)}}}));
            objects.push_back(object("AnimationCurve", first + 3, "AnimCurve::", "",
                                     {{"KeyTime", {motion.times}, {}},
                                      {"KeyValueFloat", {motion.values}, {}},
                                      {"KeyAttrFlags", {motion.flags}, {}},
                                      {"KeyAttrDataFloat", {motion.data}, {}},
                                      {"KeyAttrRefCount", {whole(motion.times.size(), 1)}, {}}}));
            links.push_back(link("OO", first + 1, first));
            links.push_back(link("OO", first + 2, first + 1));
            links.push_back(to_property(first + 2, 1, "Lcl Translation"));
            links.push_back(to_property(first + 3, first + 2, "d|X"));
            first += 10;
        };
        add(*this);
        for (auto const& motion : more) {
            add(motion);
        }
        return {{"FBXHeaderExtension", {}, {{"FBXVersion", {version}, {}}}},
                {"GlobalSettings", {}, {{"Version", {std::int32_t{1000}}, {}}, {"Properties70", {}, {rate}}}},
                {"Definitions", {}, {{"Version", {std::int32_t{100}}, {}}}},
                {"Objects", {}, objects},
                {"Connections", {}, links}};
    }

    static fbx_tree number_property(char const* name, double value) {
        return {"P", {std::string(name), std::string("Number"), std::string(), std::string("A"), value}, {}};
    }

    std::string text() const {
        std::string result = "; FBX 7.4.0 project file\n";
        for (auto const& one : records(7400)) {
            result += one.text();
        }
        return result;
    }

    std::string bytes(std::uint32_t version, bool is_packed) const {
        std::string result("Kaydara FBX Binary  \0\x1a\0", 23);
        result.append(reinterpret_cast<char const*>(&version), sizeof version);
        std::size_t const width = version >= 7500 ? 8 : 4;
        for (auto const& one : records(static_cast<std::int32_t>(version))) {
            result += one.bytes(result.size(), width, is_packed);
        }
        return result + std::string(3 * width + 1, '\0') + "whatever follows";
    }
};

} // namespace genrender::tests
