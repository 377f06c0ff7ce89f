// SPDX-License-Identifier: MIT
// Reads a folder `tokenizer/` and prompts of clip_tokenizer_parity.py and writes the ids of each.
#include <genrender/reference/clip_tokenizer_folder.hpp>

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Writes a line a prompt, its ids, to `ids_path`, and the times to the standard output.
void tokenize(std::string const& folder, std::string const& prompts_path, std::string const& ids_path) {
    std::ifstream prompts_file(prompts_path);
    auto const prompts = nlohmann::json::parse(prompts_file).get<std::vector<std::string>>();
    std::vector<clip_prompt> results;
    results.reserve(prompts.size());

    auto begin = std::chrono::steady_clock::now();
    auto const tokenizer = load_clip_tokenizer(folder);
    std::cout << "loading: " << seconds_since(begin) * 1e3 << " ms, ";
    begin = std::chrono::steady_clock::now();
    for (auto const& prompt : prompts) {
        results.push_back(tokenizer(prompt));
    }
    std::cout << "a prompt: " << seconds_since(begin) * 1e6 / static_cast<double>(prompts.size()) << " us\n";

    std::ofstream ids(ids_path);
    for (auto const& result : results) {
        for (auto const id : result.ids) {
            ids << id << " ";
        }
        ids << result.cut << "\n";
    }
}

/// Prints the code points that the Unicode version here assigns, as lines `first last`.
void print_assigned() {
    auto const is_assigned = [](std::int32_t point) {
        return point < 0x110000 && utf8proc_category(point) != UTF8PROC_CATEGORY_CN;
    };
    for (std::int32_t point = 0; point < 0x110000; ++point) {
        auto const first = point;
        while (is_assigned(point)) {
            ++point;
        }
        if (first < point) {
            std::cout << first << " " << point - 1 << "\n";
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    try {
        if (argc == 2 && std::string(argv[1]) == "--assigned") {
            print_assigned();
        } else if (argc == 4) {
            tokenize(argv[1], argv[2], argv[3]);
        } else {
            std::cerr
                << "usage: clip_tokenizer_parity --assigned | FOLDER PROMPTS IDS (see clip_tokenizer_parity.py)\n";
            return 2;
        }
        return 0;
    } catch (std::exception const& error) {
        std::cerr << "clip_tokenizer_parity: " << error.what() << "\n";
        return 1;
    }
}
