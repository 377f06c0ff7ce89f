// SPDX-License-Identifier: MIT
// Files that crash assimp's readers, hold no mesh, or say what assimp passes on wrongly.
#include <examples/support/assimp_file.hpp>

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

using namespace genrender;
using namespace genrender::examples;
using genrender::tests::scratch_folder;

namespace {

std::string reading_refusal(std::filesystem::path const& path) {
    try {
        read_assimp_file(path);
    } catch (file_error const& error) {
        return error.what();
    }
    return "no error";
}

std::filesystem::path field_input(std::string const& name) {
    return std::filesystem::path(GENRENDER_TEST_DATA) / "field" / name;
}

double rate_of(std::int32_t number, float custom) {
    aiScene scene;
    scene.mMetaData = new aiMetadata;
    scene.mMetaData->Add("FrameRate", number);
    scene.mMetaData->Add("CustomFrameRate", custom);
    return fbx_frame_rate(scene);
}

} // namespace

TEST_SUITE("examples_support/assimp_file") {
    TEST_CASE("a file that crashes a reader is refused with the reader's name") {
        auto const skin = field_input("malformed_skinweights_oob.x");
        CHECK(reading_refusal(skin) == skin.string() +
                                           ": cannot be read as a model (assimp's Direct3D XFile Importer crashed "
                                           "(Segmentation fault)), expected a whole file that assimp knows");
        auto const empty = field_input("malformed_zero_numvertices.md2");
        CHECK(reading_refusal(empty) == empty.string() +
                                            ": cannot be read as a model (assimp's Quake II Mesh Importer crashed "
                                            "(Segmentation fault)), expected a whole file that assimp knows");
    }

    TEST_CASE("a skeleton without a mesh is refused and nothing is shown in its place") {
        scratch_folder const folder;
        std::string const joints = "version 1\nnodes\n0 \"root\" -1\n1 \"knee\" 0\nend\nskeleton\n"
                                   "time 0\n0 0 0 0 0 0 0\n1 0 1 0 0 0 0\ntime 9\n0 0 0 0 0 0 0\n1 0 2 0 0 0 0\nend\n";
        auto const smd = folder.write("joints.smd", joints).string();
        CHECK(reading_refusal(smd) == smd + ": holds no mesh, only a skeleton, expected the surface as well");
        auto const bvh = folder.write("joints.bvh", "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition "
                                                    "Yposition Zposition Zrotation Xrotation Yrotation\nEnd Site\n{\n"
                                                    "OFFSET 0 1 0\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.04\n"
                                                    "0 0 0 0 0 0\n0 1 0 0 0 0\n");
        CHECK(reading_refusal(bvh) == bvh.string() + ": holds no mesh, only a skeleton, expected the surface as well");
    }

    TEST_CASE("blend shapes of an FBX file rest at 0 and those without keys are counted") {
        auto const file = read_assimp_file(field_input("shapekeys_rest.fbx"));
        REQUIRE(file.scene->mNumMeshes == 1);
        auto const& mesh = *file.scene->mMeshes[0];
        REQUIRE(mesh.mNumAnimMeshes == 6);
        for (unsigned i = 0; i < 6; ++i) {
            CHECK(mesh.mAnimMeshes[i]->mWeight == 0);
        }
        CHECK(file.notes == std::vector<std::string>{"6 blend shapes without keys stay at 0: assimp does not tell the "
                                                     "weights that an FBX file gives them."});
    }

    TEST_CASE("the frame rate of an FBX file is the one whose number it tells") {
        CHECK(rate_of(11, 25) == doctest::Approx(24));
        CHECK(rate_of(10, 24) == doctest::Approx(25));
        CHECK(rate_of(6, -1) == doctest::Approx(30));
        CHECK(rate_of(3, -1) == doctest::Approx(60));
        CHECK(rate_of(13, -1) == doctest::Approx(23.976));
        CHECK(rate_of(8, -1) == doctest::Approx(29.97));
        CHECK(rate_of(14, 12.5f) == doctest::Approx(12.5));
        CHECK(rate_of(14, 0) == doctest::Approx(24));
        CHECK(rate_of(99, 7) == doctest::Approx(24));
        CHECK(rate_of(-1, 7) == doctest::Approx(24));
        CHECK(fbx_frame_rate(aiScene()) == doctest::Approx(24));
    }

    TEST_CASE("a file that leads a reader to take ever more memory is refused") {
        scratch_folder const folder;
        // One byte that is no digit among the indices of a Collada file
        auto const dae = folder.write(
            "stray.dae",
            "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
            "<library_geometries><geometry id='g'><mesh><source id='p'><float_array id='a' count='9'>"
            "0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source='#a' count='3' stride='3'>"
            "<param name='X' type='float'/><param name='Y' type='float'/><param name='Z' type='float'/></accessor>"
            "</technique_common></source><vertices id='v'><input semantic='POSITION' source='#p'/></vertices>"
            "<triangles count='1'><input semantic='VERTEX' source='#v' offset='0'/><p>0 1\xaf 2</p></triangles>"
            "</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='w'><node id='n'>"
            "<instance_geometry url='#g'/></node></visual_scene></library_visual_scenes>"
            "<scene><instance_visual_scene url='#w'/></scene></COLLADA>");
        auto const text = reading_refusal(dae);
        CHECK(text.rfind(dae.string() + ": cannot be read as a model (", 0) == 0);
        MESSAGE(text);
    }

    TEST_CASE("a folder that is called as a model is refused as a file that is missing is") {
        scratch_folder const folder;
        std::filesystem::create_directory(folder / "model.fbx");
        for (std::string const name : {"model.fbx", "missing.fbx", "missing"}) {
            auto const path = (folder / name).string();
            CHECK(reading_refusal(path).rfind(path + ": cannot be read as a model (", 0) == 0);
        }
    }

    TEST_CASE("a larger file may take longer and more") {
        scratch_folder const folder;
        CHECK(genrender::examples::detail::limits_for(folder.write("small", "x")).processor_seconds == 60);
        auto const large = genrender::examples::detail::limits_for(folder.write("large", std::string(3 << 20, 'x')));
        CHECK(large.processor_seconds == 90);
        CHECK(large.bytes > 1'600'000'000);
        CHECK(genrender::examples::detail::limits_for(folder / "missing").bytes == 1 << 30);
    }
}
