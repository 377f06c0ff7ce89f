// SPDX-License-Identifier: MIT
// Tests of telling pickles from safetensors.
#include <genrender/reference/pickles.hpp>

#include "small_networks.hpp"

#include <genrender/reference/safetensors.hpp>

#include <doctest/doctest.h>

#include <fstream>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using testing::temporary_file;

TEST_SUITE("reference/pickles") {
    TEST_CASE("a pickle is known by its name") {
        for (auto const* name : {"a.bin", "a.ckpt", "b/a.pt", "a.safetensors.pth"}) {
            CHECK(is_pickle_name(name));
        }
        for (auto const* name : {"a.safetensors", "ckpt", "a.ckpt.safetensors", "a.json", ""}) {
            CHECK_FALSE(is_pickle_name(name));
        }
    }

    TEST_CASE("a pickle is known by its first bytes whatever its name is") {
        temporary_file const file("model.safetensors");
        auto const is_pickle = [&](std::string const& content) {
            std::ofstream(file.path(), std::ios::binary) << content;
            return is_pickle_content(file.path());
        };
        CHECK(is_pickle(std::string("PK\3\4\0\0\0\0\0\0", 10)));
        CHECK(is_pickle(std::string("\x80\2\x8a\nl\xfc\x9c", 7)));
        CHECK_FALSE(is_pickle(""));
        CHECK_FALSE(is_pickle("PK"));
        CHECK_FALSE(is_pickle(std::string("\x80\2\0\0\0\0\0\0{", 9)));
        CHECK_FALSE(is_pickle_content("/nowhere"));
        std::vector<float> const one{1};
        write_safetensors(file.path(), {{"a", {{1}, one}}});
        CHECK_FALSE(is_pickle_content(file.path()));
        CHECK_NOTHROW(refuse_pickle(file.path()));
    }

    TEST_CASE("the refusal says why and how to convert") {
        CHECK_THROWS_WITH_AS(
            refuse_pickle("some/model.ckpt"),
            "some/model.ckpt: file is a Python pickle, and to read one is to run the code in it, expected a "
            "safetensors "
            "file; if you trust where it is from, convert it with: python3 -c \"import sys, torch; from "
            "safetensors.torch import save_file; s = torch.load(sys.argv[1], map_location='cpu', weights_only=True); s "
            "= s.get('state_dict', s); save_file({k: v.clone().contiguous() for k, v in s.items() if "
            "torch.is_tensor(v)}, sys.argv[2])\" 'some/model.ckpt' 'some/model.safetensors'",
            file_error);
    }

    TEST_CASE("pickles of a folder are found in order") {
        temporary_file const file("folder");
        std::filesystem::path const folder = file.path();
        std::filesystem::create_directories(folder);
        CHECK(pickles_in(folder).empty());
        CHECK(pickles_in(folder / "nowhere").empty());
        for (auto const* name : {"b.bin", "a.pt", "c.json"}) {
            std::ofstream(folder / name) << "x";
        }
        CHECK(pickles_in(folder) == std::vector<std::filesystem::path>{folder / "a.pt", folder / "b.bin"});
    }
}
