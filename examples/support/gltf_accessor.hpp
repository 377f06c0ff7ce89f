// SPDX-License-Identifier: MIT
// The numbers of a glTF file: of any integer or float type, normalised or not, interleaved or sparse.
#pragma once

#include "gltf_document.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace genrender::examples {

/// Numbers of one accessor.
template <class Number>
struct gltf_numbers {
    std::vector<Number> values; ///< [count][width]
    std::size_t count = 0;
    std::size_t width = 0; ///< 1 of a scalar, 3 of a position, 16 of a matrix, column by column
};

/// Reads accessors of a document, which must outlive it. Every number of view, buffer, offset and count is checked;
/// what is wrong throws file_error, in which `what` names what the numbers are of.
class gltf_accessors {
public:
    explicit gltf_accessors(gltf_document const& document) : document_(&document) {
        for (auto const& buffer : document.model.buffers) {
            bytes_ += buffer.data.size();
        }
        require_size();
    }

    /// As floats; integers that are normalised become [0, 1] or [-1, 1]. `type` is TINYGLTF_TYPE_VEC3 and the like.
    gltf_numbers<float> floats(int accessor, int type, std::string const& what) {
        return read<float>(accessor, type, what);
    }

    /// As integers of at least 0.
    gltf_numbers<std::uint32_t> integers(int accessor, int type, std::string const& what) {
        auto const component = checked(accessor, what).componentType;
        if (component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
            component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
            refuse(accessor, what, "is not of unsigned integers");
        }
        return read<std::uint32_t>(accessor, type, what);
    }

private:
    /// Refuses a file whose meshes are too large together before any of them is read.
    void require_size() const {
        std::size_t numbers = 0;
        auto const count = [&](int accessor) {
            auto const& all = document_->model.accessors;
            if (accessor < 0 || static_cast<std::size_t>(accessor) >= all.size() ||
                all[static_cast<std::size_t>(accessor)].count > bytes_) {
                return; // which is refused by its name when it is read
            }
            auto const& one = all[static_cast<std::size_t>(accessor)];
            auto const width = std::max(1, tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(one.type)));
            numbers += one.count * static_cast<std::size_t>(width);
            if (numbers > most_numbers) {
                refuse_size();
            }
        };
        for (auto const& mesh : document_->model.meshes) {
            for (auto const& primitive : mesh.primitives) {
                for (auto const& [name, accessor] : primitive.attributes) {
                    count(accessor);
                }
                for (auto const& target : primitive.targets) {
                    for (auto const& [name, accessor] : target) {
                        count(accessor);
                    }
                }
            }
        }
    }

    [[noreturn]] void refuse_size() const {
        document_->refuse("holds more than " + std::to_string(most_numbers) + " numbers, expected a smaller model");
    }

    [[noreturn]] void refuse(int accessor, std::string const& what, std::string const& fault) const {
        document_->refuse("accessor " + std::to_string(accessor) + ", " + what + ", " + fault +
                          ", expected numbers that are all in the file");
    }

    tinygltf::Accessor const& checked(int accessor, std::string const& what) const {
        auto const& all = document_->model.accessors;
        if (accessor < 0 || static_cast<std::size_t>(accessor) >= all.size()) {
            refuse(accessor, what, "is none of the file's " + std::to_string(all.size()));
        }
        return all[static_cast<std::size_t>(accessor)];
    }

    /// Elements of one view.
    struct strided {
        unsigned char const* first = nullptr;
        std::size_t stride = 0;
        unsigned char const* operator[](std::size_t i) const { return first + i * stride; }
    };

    /// `count` > 0 elements of `size` bytes, from `offset` on in the view.
    strided elements(int view, std::size_t offset, std::size_t count, std::size_t size, int accessor,
                     std::string const& what) const {
        auto const& model = document_->model;
        if (view < 0 || static_cast<std::size_t>(view) >= model.bufferViews.size()) {
            refuse(accessor, what, "lies in buffer view " + std::to_string(view) + ", which is none");
        }
        auto const& place = model.bufferViews[static_cast<std::size_t>(view)];
        if (place.buffer < 0 || static_cast<std::size_t>(place.buffer) >= model.buffers.size()) {
            refuse(accessor, what, "lies in buffer " + std::to_string(place.buffer) + ", which is none");
        }
        auto const& bytes = model.buffers[static_cast<std::size_t>(place.buffer)].data;
        if (place.byteOffset > bytes.size() || place.byteLength > bytes.size() - place.byteOffset) {
            refuse(accessor, what, "lies in a buffer view that ends beyond its buffer");
        }
        auto const stride = place.byteStride > 0 ? place.byteStride : size;
        if (size > place.byteLength || offset > place.byteLength - size ||
            (count - 1) > (place.byteLength - size - offset) / stride) {
            refuse(accessor, what, "ends beyond its buffer view");
        }
        return {bytes.data() + place.byteOffset + offset, stride};
    }

    template <class Component>
    static Component component_at(unsigned char const* bytes, std::size_t i) {
        Component value;
        std::memcpy(&value, bytes + i * sizeof value, sizeof value);
        return value;
    }

    /// The i-th component of an element.
    template <class Number>
    static Number number_at(unsigned char const* element, std::size_t i, int component, bool is_normalized) {
        auto const scaled = [&](auto value, float most) {
            return is_normalized ? static_cast<Number>(std::max(static_cast<float>(value) / most, -1.0f))
                                 : static_cast<Number>(value);
        };
        switch (component) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return scaled(component_at<std::int8_t>(element, i), 127.0f);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return scaled(component_at<std::uint8_t>(element, i), 255.0f);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return scaled(component_at<std::int16_t>(element, i), 32767.0f);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return scaled(component_at<std::uint16_t>(element, i), 65535.0f);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return scaled(component_at<std::uint32_t>(element, i), 4294967295.0f);
        default:
            return static_cast<Number>(component_at<float>(element, i));
        }
    }

    static std::size_t component_size(int component) {
        switch (component) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
        }
    }

    template <class Number>
    gltf_numbers<Number> read(int accessor, int type, std::string const& what) {
        auto const& source = checked(accessor, what);
        auto const size = component_size(source.componentType);
        if (source.type != type || size == 0) {
            refuse(accessor, what, "is of another type");
        }
        gltf_numbers<Number> result;
        result.count = source.count;
        result.width = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
        if (source.bufferView < 0 && source.count > bytes_) { // zeros, of which a small file can claim any number
            refuse(accessor, what, "has more elements than the file has bytes");
        }
        auto const copy = [&](strided const& from, std::size_t i, std::size_t to) {
            for (std::size_t k = 0; k < result.width; ++k) {
                result.values[to * result.width + k] =
                    number_at<Number>(from[i], k, source.componentType, source.normalized);
            }
        };
        strided all;
        if (source.bufferView >= 0 && source.count > 0) {
            all = elements(source.bufferView, source.byteOffset, source.count, size * result.width, accessor, what);
        }
        if (source.count > (most_numbers - numbers_) / result.width) {
            refuse_size();
        }
        numbers_ += source.count * result.width;
        result.values.resize(source.count * result.width);
        for (std::size_t i = 0; all.first != nullptr && i < source.count; ++i) {
            copy(all, i, i);
        }
        if (source.sparse.isSparse && source.sparse.count != 0) {
            place_sparse(source, accessor, what, size * result.width, copy);
        }
        return result;
    }

    /// Copies the elements that differ from the rest to their places.
    void place_sparse(tinygltf::Accessor const& source, int accessor, std::string const& what, std::size_t size,
                      auto const& copy) const {
        auto const& sparse = source.sparse;
        auto const kind = sparse.indices.componentType;
        if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > source.count ||
            sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0 ||
            (kind != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && kind != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
             kind != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)) {
            refuse(accessor, what, "has sparse elements of a kind that cannot be");
        }
        auto const count = static_cast<std::size_t>(sparse.count);
        auto const indices = elements(sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
                                      count, component_size(kind), accessor, what);
        auto const values = elements(sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                                     count, size, accessor, what);
        for (std::size_t i = 0; i < count; ++i) {
            auto const to = number_at<std::uint32_t>(indices[i], 0, kind, false);
            if (to >= source.count) {
                refuse(accessor, what, "has a sparse element beyond its end");
            }
            copy(values, i, to);
        }
    }

    static constexpr std::size_t most_numbers = 250'000'000; ///< that are read: one gigabyte

    gltf_document const* document_;
    std::size_t bytes_ = 0;   ///< of all buffers
    std::size_t numbers_ = 0; ///< read so far
};

} // namespace genrender::examples
