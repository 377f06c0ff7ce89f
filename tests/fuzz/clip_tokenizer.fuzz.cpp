// SPDX-License-Identifier: MIT
// A tokenizer's files and a prompt from a stranger. An input is sections that begin with a form feed and a letter: v, m, t,
// c, s, a for vocab.json, merges.txt, tokenizer.json and so on, p for the prompt, which is all that is left.
#include <genrender/core/error.hpp>
#include <genrender/reference/clip_tokenizer.hpp>
#include <genrender/reference/clip_tokenizer_folder.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

using namespace genrender;

using namespace genrender::reference;

namespace {

/// Ends the program where the library broke a promise.
void promise(bool holds, char const* what) {
    if (!holds) {
        std::fprintf(stderr, "broken promise: %s\n", what);
        std::abort();
    }
}

/// Every byte alone, and some merges: prompts reach all of the tokenizer whatever the files are.
clip_tokenizer small_tokenizer() {
    std::unordered_map<std::string, std::uint32_t> vocabulary;
    auto const add = [&](std::string const& token) {
        vocabulary.emplace(token, static_cast<std::uint32_t>(vocabulary.size()));
    };
    for (unsigned byte = 0; byte < 256; ++byte) {
        auto const letter = byte_letter(static_cast<unsigned char>(byte));
        add(utf8_text({&letter, 1}));
        add(utf8_text({&letter, 1}) + "</w>");
    }
    std::pair<char const*, char const*> const merges[] = {{"a", "a"}, {"aa", "a"}, {"b", "a</w>"}, {"aa", "aa</w>"}};
    for (auto const* token : {"aa", "aaa", "ba</w>", "aa</w>", "aaaa</w>", "<|startoftext|>", "<|endoftext|>"}) {
        add(token);
    }
    byte_pair_encoding encoding(std::move(vocabulary), "<|endoftext|>");
    for (auto const& [left, right] : merges) {
        encoding.add_merge(left, right);
    }
    clip_special_tokens special;
    special.added = {{"<|startoftext|>", true}, {"<Cat>", false}, {"Dog", true}, {"!", false}};
    return clip_tokenizer(std::move(encoding), special);
}

void tokenize(clip_tokenizer const& tokenizer, std::string_view text) {
    try {
        auto const prompt = tokenizer(text);
        promise(prompt.ids.size() == tokenizer.context_length(), "a prompt has the context length");
        promise(prompt.ids.front() == tokenizer.start(), "a prompt begins with the start");
        promise(prompt.ids[prompt.tokens + 1] == tokenizer.end(), "the end is behind the text");
        promise(std::all_of(prompt.ids.begin(), prompt.ids.end(), [&](auto id) { return id < tokenizer.size(); }),
                "ids are rows of the embeddings");
        std::size_t tokens = 0;
        std::size_t kept = 0;
        for (auto const& word : prompt.words) {
            promise(word.tokens > 0 && word.kept <= word.tokens && !word.text.empty(), "a word has tokens");
            tokens += word.tokens;
            kept += word.kept;
        }
        promise(kept == prompt.tokens && tokens == prompt.tokens + prompt.cut, "words have the tokens of the text");
        promise(prompt.cut_text().empty() == (prompt.cut == 0), "what is cut is told");
    } catch (value_error const&) {
        // The prompt is no UTF-8.
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    std::map<char, char const*> const names{{'v', "vocab.json"},
                                            {'m', "merges.txt"},
                                            {'t', "tokenizer.json"},
                                            {'c', "tokenizer_config.json"},
                                            {'s', "special_tokens_map.json"},
                                            {'a', "added_tokens.json"}};
    std::string_view rest(reinterpret_cast<char const*>(data), size);
    std::string_view prompt;
    clip_tokenizer_files files{"folder", {}};
    for (auto at = rest.find('\f'); at != std::string_view::npos && at + 1 < rest.size();) {
        auto const letter = rest[at + 1];
        auto const text = rest.substr(at + 2);
        if (letter == 'p') {
            prompt = text;
            break;
        }
        auto const next = text.find('\f');
        if (auto const name = names.find(letter); name != names.end()) {
            files.texts[name->second] = std::string(text.substr(0, next));
        }
        at = next == std::string_view::npos ? next : at + 2 + next;
    }

    static clip_tokenizer const small = small_tokenizer();
    tokenize(small, prompt);
    try {
        tokenize(make_clip_tokenizer(files), prompt);
    } catch (file_error const&) {
        // The files are none of a tokenizer.
    }
    return 0;
}
