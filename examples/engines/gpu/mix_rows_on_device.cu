// SPDX-License-Identifier: MIT
// The kernel of eq. 6 on this machine's GPU: against the host's definition, and its speed against that of a copy.
#include <genrender/adapters/cuda/mix_rows.cuh>
#include <genrender/blending/call_rows.hpp>
#include <genrender/blending/padded_rows.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

namespace cuda = genrender::adapters::cuda;

void require(cudaError_t code, char const* what) {
    if (code != cudaSuccess) {
        throw std::runtime_error(std::string(what) + ": " + cudaGetErrorString(code));
    }
}

/// An array on the device.
template <class T>
struct device_array {
    T* data = nullptr;
    std::size_t size = 0;
    explicit device_array(std::vector<T> const& values) : size(values.size()) {
        require(cudaMalloc(&data, size * sizeof(T)), "cudaMalloc");
        require(cudaMemcpy(data, values.data(), size * sizeof(T), cudaMemcpyHostToDevice), "cudaMemcpy");
    }
    device_array(device_array const&) = delete;
    device_array& operator=(device_array const&) = delete;
    ~device_array() { cudaFree(data); }
    std::vector<T> on_host() const {
        std::vector<T> values(size);
        require(cudaMemcpy(values.data(), data, size * sizeof(T), cudaMemcpyDeviceToHost), "cudaMemcpy");
        return values;
    }
};

float widened(float x) { return x; }
float widened(__half x) { return __half2float(x); }
float widened(__nv_bfloat16 x) { return __bfloat162float(x); }
void rounded(float& to, float x) { to = x; }
void rounded(__half& to, float x) { to = __float2half_rn(x); }
void rounded(__nv_bfloat16& to, float x) { to = __float2bfloat16_rn(x); }

template <class T>
std::vector<T> numbers(std::size_t count, std::mt19937& source) {
    std::uniform_real_distribution<float> draw(-1, 1);
    std::vector<T> values(count);
    for (auto& value : values) {
        rounded(value, draw(source));
    }
    return values;
}

/// The best of some runs, in seconds.
template <class Work>
double seconds_of(Work const& work) {
    cudaEvent_t begin{};
    cudaEvent_t end{};
    require(cudaEventCreate(&begin), "cudaEventCreate");
    require(cudaEventCreate(&end), "cudaEventCreate");
    float best = 1e9f;
    for (int i = 0; i < 20; ++i) {
        require(cudaEventRecord(begin), "cudaEventRecord");
        work();
        require(cudaEventRecord(end), "cudaEventRecord");
        require(cudaEventSynchronize(end), "cudaEventSynchronize");
        float milliseconds = 0;
        require(cudaEventElapsedTime(&milliseconds, begin, end), "cudaEventElapsedTime");
        best = std::min(best, milliseconds);
    }
    cudaEventDestroy(begin);
    cudaEventDestroy(end);
    return static_cast<double>(best) / 1e3;
}

/// One row of the table: F of `Real` and F_KF of `Stored`. Returns whether the kernel is right.
template <class Real, class Stored>
bool compare(char const* name, std::size_t frames, std::size_t tokens, std::size_t channels, float bound) {
    constexpr std::size_t keyframes = 3;
    constexpr std::size_t width = 3;
    std::mt19937 source(7);
    auto const F = numbers<Real>(frames * tokens * channels, source);
    auto const bank = numbers<Stored>(keyframes * tokens * channels, source);
    genrender::padded_rows<float> rows{frames, tokens, width, {}, {}, {}};
    genrender::call_rows<float> lists; // the same
    for (std::size_t row = 0; row < frames * tokens; ++row) {
        bool const is_covered = row % 4 != 0;
        for (std::size_t w = 0; w < width; ++w) {
            // Neighbours read neighbours, as tokens of a surface do; every fifth row has an entry less.
            bool const is_used = is_covered && (w + 1 < width || row % 5 != 0);
            rows.index.push_back(is_used ? static_cast<std::int32_t>(w * tokens + (row + 17 * w) % tokens) : 0);
            rows.weights.push_back(is_used ? 0.8f / static_cast<float>(row % 5 != 0 ? width : width - 1) : 0.0f);
            if (is_used) {
                lists.index.push_back(rows.index.back());
                lists.weights.push_back(rows.weights.back());
            }
        }
        rows.own.push_back(is_covered ? 0.2f : 1.0f);
        lists.offsets.push_back(static_cast<std::int32_t>(lists.index.size()));
    }
    device_array<Real> const device_F(F);
    device_array<Stored> const device_bank(bank);
    device_array<std::int32_t> const index(rows.index);
    device_array<float> const weights(rows.weights);
    device_array<float> const own(rows.own);
    cuda::device_rows const plan{index.data, weights.data, own.data, static_cast<std::int32_t>(frames * tokens),
                                 static_cast<std::int32_t>(width)};
    auto const mix = [&] {
        require(cuda::mix_rows(device_F.data, device_bank.data, plan, static_cast<std::int32_t>(channels)), "mix_rows");
    };
    mix();
    auto const got = device_F.on_host();
    device_array<Real> const listed_F(F);
    device_array<std::int32_t> const list_offsets(lists.offsets);
    device_array<std::int32_t> const list_index(lists.index);
    device_array<float> const list_weights(lists.weights);
    cuda::device_row_lists const list_plan{list_offsets.data, list_index.data, list_weights.data, own.data, plan.rows};
    require(cuda::mix_rows(listed_F.data, device_bank.data, list_plan, static_cast<std::int32_t>(channels)),
            "mix_rows");
    auto const listed = listed_F.on_host();

    std::vector<float> expected(F.size());
    std::vector<float> wide_bank(bank.size());
    std::transform(F.begin(), F.end(), expected.begin(), [](Real x) { return widened(x); });
    std::transform(bank.begin(), bank.end(), wide_bank.begin(), [](Stored x) { return widened(x); });
    genrender::mix_padded_rows<float>(
        {expected.data(), {frames, tokens, channels}},
        genrender::strided_view<float const, 3>(wide_bank.data(), {keyframes, tokens, channels}), rows.view());
    float greatest = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        for (auto const value : {widened(got[i]), widened(listed[i])}) {
            auto const apart = std::abs(value - expected[i]);
            greatest = apart <= greatest ? greatest : apart;
        }
    }

    // What has to move: F of covered rows in and out, every row of the bank that is read, the plan.
    double const covered = 0.75 * static_cast<double>(F.size() * sizeof(Real));
    double const entries =
        static_cast<double>(std::count_if(rows.weights.begin(), rows.weights.end(), [](float w) { return w != 0; }));
    double const bytes = 2 * covered + entries * static_cast<double>(channels * sizeof(Stored)) +
                         static_cast<double>(rows.weights.size() * 8 + rows.own.size() * 4);
    auto const seconds = seconds_of(mix);
    device_array<Real> const other(F);
    auto const copy_seconds = seconds_of([&] {
        require(cudaMemcpyAsync(other.data, device_F.data, F.size() * sizeof(Real), cudaMemcpyDeviceToDevice),
                "cudaMemcpyAsync");
    });
    auto const copied = 2 * static_cast<double>(F.size() * sizeof(Real));
    bool const is_right = greatest <= bound;
    std::printf("| %s | %zu x %zu x %zu | %.1e%s | %.3f | %.0f | %.0f |\n", name, frames, tokens, channels,
                static_cast<double>(greatest), is_right ? "" : " WRONG", 1e3 * seconds, bytes / seconds / 1e9,
                copied / copy_seconds / 1e9);
    return is_right;
}

} // namespace

int main() {
    try {
        int devices = 0;
        if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
            std::printf("skipped: there is no CUDA device\n");
            return 77;
        }
        cudaDeviceProp device{};
        require(cudaGetDeviceProperties(&device, 0), "cudaGetDeviceProperties");
        std::printf(
            "%s\n\n| F, F_KF | frames x tokens x channels | greatest difference | ms | GB/s | GB/s of a copy |\n"
            "|---|---|---|---|---|---|\n",
            device.name);
        bool is_right = true;
        for (auto const& [frames, tokens, channels] :
             {std::array<std::size_t, 3>{8, 4096, 320}, {8, 1024, 640}, {8, 256, 1280}, {3, 100, 7}}) {
            is_right = compare<float, float>("f32, f32", frames, tokens, channels, 1e-6f) && is_right;
            is_right = compare<float, __half>("f32, f16", frames, tokens, channels, 1e-6f) && is_right;
            is_right = compare<__half, __half>("f16, f16", frames, tokens, channels, 5e-4f) && is_right;
            is_right = compare<__nv_bfloat16, __nv_bfloat16>("bf16, bf16", frames, tokens, channels, 4e-3f) && is_right;
        }
        return is_right ? 0 : 1;
    } catch (std::exception const& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
