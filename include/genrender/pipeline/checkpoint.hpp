// SPDX-License-Identifier: MIT
// A run after one of its steps: all that it takes to go on to the same frames, and its way through a stream of the user's.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/fingerprint.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/core/vector_target.hpp>
#include <genrender/pipeline/render_report.hpp>
#include <genrender/pipeline/run_fingerprint.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <istream>
#include <limits>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace genrender {

/// What is left of a run after a step; `render` makes it when after_step asks (finished_step) and goes on from it by
/// `resume`. Keyframes, sources of a consensus and noise are addressed by seed and step, and neither normalisation nor
/// methods remember anything, so that there is no more.
template <class Real>
struct checkpoint {
    std::size_t steps = 0; ///< that are done; the next is step `steps`, counted from 0
    latents<Real> z = latents<Real>::from_shape({0, 0, 0, 0}); ///< [frames, channels, height, width] after these
    std::optional<latents<Real>> x0_last{}; ///< the last clean estimate, of a sampler that remembers_estimates
    run_fingerprint run;                    ///< whose checkpoint it is
    render_report report;                   ///< what has happened so far
};

/// Throws value_error unless a checkpoint is of a run of this fingerprint, shape of z, number of steps and vector target,
/// with a sentence that names what differs; shape_error for latents of other extents than the run's.
template <class Real>
void require_resumable(checkpoint<Real> const& from, run_fingerprint const& run,
                       std::array<std::size_t, 4> const& shape, std::size_t steps, bool remembers_estimates) {
    std::string others;
    auto const differs = [&](bool differ, char const* what) {
        others += differ ? (others.empty() ? "" : " and ") + std::string(what) : "";
    };
    differs(from.run.settings != run.settings, "settings");
    differs(from.run.maps != run.maps, "maps");
    differs(from.run.model != run.model, "model");
    if (!others.empty()) {
        throw value_error("render: resume is a checkpoint of a run that differs in " + others +
                          ", expected one with the same settings, maps and model");
    }
    auto const kernels = chosen_vector_target();
    require_value(from.report.kernels == kernels, "render", "resume.report.kernels", name_of(from.report.kernels),
                  (std::string(name_of(kernels)) + ", the vector target of this run (force_vector_target)").c_str());
    require_value(from.steps <= steps, "render", "resume.steps", from.steps, "at most settings.steps");
    require_extents("render", "resume.z", from.z.shape(), shape);
    require_value(!remembers_estimates || from.steps == 0 || from.x0_last.has_value(), "render", "resume.x0_last",
                  "empty", "the last clean estimate, which the sampler remembers");
    if (from.x0_last) {
        require_extents("render", "resume.x0_last", from.x0_last->shape(), shape);
    }
}

namespace detail {

/// What a stream of a checkpoint begins with; the digits are those of the format's version.
inline constexpr std::array<char, 16> checkpoint_magic{'g', 'e', 'n', 'r', 'e', 'n', 'd', 'e',
                                                       'r', '-', 'c', 'k', 'p', 't', '0', '1'};
template <class Real>
using bits_of = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;

/// A word whose bytes in memory stand with the lowest first, or back; on most machines itself.
template <std::unsigned_integral Word>
constexpr Word lowest_first(Word word) {
    if constexpr (std::endian::native == std::endian::little) {
        return word;
    }
    Word turned = 0;
    for (std::size_t byte = 0; byte < sizeof(Word); ++byte) {
        turned = static_cast<Word>(turned << 8 | (word >> (8 * byte) & 0xff));
    }
    return turned;
}

/// Writes numbers, lowest byte first, and takes in all that it wrote.
class checkpoint_writer {
public:
    explicit checkpoint_writer(std::ostream& to) : to_(&to) {}
    void bytes(std::span<char const> all) {
        sum_.add(std::string_view(all.data(), all.size()));
        to_->write(all.data(), static_cast<std::streamsize>(all.size()));
    }
    /// Numbers of one width.
    template <std::unsigned_integral Word, class Values>
    void words(Values const& values, std::size_t count) {
        constexpr std::size_t most = 8192;
        std::vector<char> block;
        for (std::size_t begin = 0; begin < count; begin += most) {
            block.resize(std::min(most, count - begin) * sizeof(Word));
            for (std::size_t i = 0; i < block.size(); i += sizeof(Word)) {
                auto const word = lowest_first(std::bit_cast<Word>(values[begin + i / sizeof(Word)]));
                std::memcpy(block.data() + i, &word, sizeof(Word));
            }
            bytes(block);
        }
    }
    void word(std::uint64_t value) { words<std::uint64_t>(&value, 1); }
    void number(double value) { word(std::bit_cast<std::uint64_t>(value)); }
    std::uint64_t sum() const { return sum_.value(); }

private:
    std::ostream* to_;
    fingerprint sum_;
};

/// Reads what a checkpoint_writer wrote, a block at a time: what a damaged stream says of its size takes no memory before
/// the bytes are there.
class checkpoint_reader {
public:
    explicit checkpoint_reader(std::istream& from) : from_(&from) {}
    [[noreturn]] static void refuse(std::string const& what) { throw file_error("checkpoint: " + what); }
    void bytes(std::span<char> all) {
        from_->read(all.data(), static_cast<std::streamsize>(all.size()));
        auto const got = static_cast<std::size_t>(from_->gcount());
        read_ += got;
        if (got != all.size()) {
            refuse("ends after " + std::to_string(read_) + " bytes, expected more");
        }
        sum_.add(std::string_view(all.data(), all.size()));
    }
    /// Numbers of one width, each handed to `take`.
    template <std::unsigned_integral Word, class Take>
    void words(std::size_t count, Take const& take) {
        constexpr std::size_t most = 8192;
        std::vector<char> block;
        for (std::size_t begin = 0; begin < count; begin += most) {
            block.resize(std::min(most, count - begin) * sizeof(Word));
            bytes(block);
            for (std::size_t i = 0; i < block.size(); i += sizeof(Word)) {
                Word word = 0;
                std::memcpy(&word, block.data() + i, sizeof(Word));
                take(lowest_first(word));
            }
        }
    }
    std::uint64_t word() {
        std::uint64_t value = 0;
        words<std::uint64_t>(1, [&](std::uint64_t read) { value = read; });
        return value;
    }
    double number() { return std::bit_cast<double>(word()); }
    /// A number that is at most `most`.
    std::size_t size(char const* what, std::uint64_t most) {
        auto const value = word();
        if (value > most) {
            refuse(std::string(what) + " is " + std::to_string(value) + ", expected at most " + std::to_string(most));
        }
        return static_cast<std::size_t>(value);
    }
    /// Latents of this shape.
    template <class Real>
    latents<Real> stack(std::array<std::size_t, 4> const& shape, std::size_t count) {
        std::vector<Real> values;
        words<bits_of<Real>>(count, [&](bits_of<Real> bits) { values.push_back(std::bit_cast<Real>(bits)); });
        auto result = latents<Real>::from_shape({shape[0], shape[1], shape[2], shape[3]});
        std::copy(values.begin(), values.end(), result.data());
        return result;
    }
    std::uint64_t sum() const { return sum_.value(); }

private:
    std::istream* from_;
    fingerprint sum_;
    std::size_t read_ = 0;
};

} // namespace detail

/// Writes a checkpoint to a binary stream: what tells it from others, its sizes, its numbers to the bit, and a sum of all.
/// A file that must survive a crash is written under another name first. Throws file_error if the stream fails.
template <std::floating_point Real>
void write_checkpoint(std::ostream& to, checkpoint<Real> const& from) {
    detail::checkpoint_writer out(to);
    out.bytes(detail::checkpoint_magic);
    out.word(sizeof(Real));
    out.word(from.steps);
    for (auto const extent : from.z.shape()) {
        out.word(extent);
    }
    out.word(from.x0_last ? 1 : 0);
    for (auto const part : {from.run.settings, from.run.maps, from.run.model}) {
        out.word(part);
    }
    auto const& report = from.report;
    out.word(static_cast<std::uint64_t>(report.kernels));
    out.number(report.denoiser_seconds);
    out.number(report.library_seconds);
    out.number(report.consensus_seconds);
    out.word(report.consensus.on_objects);
    out.word(report.consensus.covered);
    out.word(report.coverage.size());
    for (auto const& [grid, count] : report.coverage) {
        for (auto const value : {grid.height, grid.width, count.on_objects, count.covered}) {
            out.word(value);
        }
    }
    out.word(report.skipped_frames.size());
    for (auto const frame : report.skipped_frames) {
        out.word(frame);
    }
    using bits = detail::bits_of<Real>;
    out.words<bits>(from.z.data(), from.z.size());
    if (from.x0_last) {
        require_extents("write_checkpoint", "x0_last", from.x0_last->shape(), from.z.shape());
        out.words<bits>(from.x0_last->data(), from.x0_last->size());
    }
    out.word(out.sum());
    if (!to.flush()) {
        throw file_error("checkpoint: not all of it could be written, expected room for it");
    }
}

/// Reads what write_checkpoint wrote; what follows it in the stream stays there. Throws file_error for a stream that ends
/// early, holds something else or latents of another scalar, or was changed in any byte.
template <std::floating_point Real>
checkpoint<Real> read_checkpoint(std::istream& from) {
    detail::checkpoint_reader in(from);
    std::array<char, 16> magic{};
    in.bytes(magic);
    if (magic != detail::checkpoint_magic) {
        in.refuse("begins with other bytes than one that this version writes, expected a checkpoint of genrender");
    }
    auto const width = in.word();
    if (width != sizeof(Real)) {
        in.refuse("its numbers are of " + std::to_string(width) + " bytes, expected " + std::to_string(sizeof(Real)));
    }
    checkpoint<Real> to;
    to.steps = in.size("number of steps", std::numeric_limits<std::uint32_t>::max());
    std::array<std::size_t, 4> shape{};
    std::size_t count = 1;
    for (auto& extent : shape) {
        // So that all bytes can be counted, and no stream is read for what no memory holds.
        extent = in.size("extent of latents", (std::uint64_t{1} << 40) / count);
        count *= extent;
        if (count == 0) {
            in.refuse("extent of latents is 0, expected 1 or more");
        }
    }
    auto const has_estimate = in.size("number of estimates", 1) != 0;
    for (auto* const part : {&to.run.settings, &to.run.maps, &to.run.model}) {
        *part = in.word();
    }
    auto& report = to.report;
    report.kernels =
        static_cast<vector_target>(in.size("vector target", static_cast<std::uint64_t>(vector_target::v4)));
    for (auto* const seconds : {&report.denoiser_seconds, &report.library_seconds, &report.consensus_seconds}) {
        *seconds = in.number();
    }
    report.consensus.on_objects = in.word();
    report.consensus.covered = in.word();
    for (auto left = in.word(); left > 0; --left) {
        grid_extents grid;
        grid.height = in.word();
        grid.width = in.word();
        auto& counted = report.coverage[grid];
        counted.on_objects = in.word();
        counted.covered = in.word();
    }
    for (auto left = in.word(); left > 0; --left) {
        report.skipped_frames.insert(in.word());
    }
    to.z = in.stack<Real>(shape, count);
    if (has_estimate) {
        to.x0_last = in.stack<Real>(shape, count);
    }
    auto const sum = in.sum();
    if (in.word() != sum) {
        in.refuse("its bytes do not add up to the sum that it ends with, expected one that nobody changed");
    }
    return to;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
