// SPDX-License-Identifier: GPL-3.0-or-later
// Small sound files of every dialect that our writers know, and some broken ones by hand.
#include "fuzz/seeds.h"

#include "fuzz/svg_seeds.h"
#include "formats/glb_builder.h"
#include "formats/mesh_io.h"
#include "formats/model_samples.h"
#include "formats/obj/obj.h"
#include "formats/png/png16.h"
#include "formats/container/zip.h"

namespace formwright::fuzz {
namespace {

Seeds* seeds;

void save(const std::string& target, const std::string& name, ByteView bytes) {
  (*seeds)[target][name] = Bytes(bytes.begin(), bytes.end());
}
void save(const std::string& target, const std::string& name, std::string_view text) {
  save(target, name, as_bytes(text));
}

void add_mesh_seeds() {
  Context context;
  Model plain = test::wavy_torus(4, 3);
  Model full = plain;
  test::add_materials_and_groups(full);
  Model coloured = plain;
  test::add_colours(coloured);
  const auto columns = test::sample_columns(plain);
  const char* names[] = {"obj", "stl", "ply", "glb", "three_mf"};
  for (const auto& info : mesh_formats) {
    const std::string target = names[static_cast<std::size_t>(info.format)];
    WriteOptions options;
    options.columns = columns;
    options.material_library = "m.mtl";
    for (const bool ascii : {false, true}) {
      options.ascii = ascii;
      const std::string suffix = ascii ? "_ascii" : "";
      if (ascii && info.format != MeshFormat::stl && info.format != MeshFormat::ply) continue;
      save(target, "plain" + suffix, write_model(plain, info.format, options, context));
      save(target, "full" + suffix, write_model(full, info.format, options, context));
      save(target, "coloured" + suffix, write_model(coloured, info.format, options, context));
    }
  }
  save("obj", "dialects",
       "# c\r\nv 0 0 0 1 0 0\r\nv 1 0 0\\\r\n 0 1 0\r\nv 1 1 0\r\nv .2 .2 0\r\nv 0 1 0\r\nvt 0 0\r\nvn 0 0 1\r\ng a "
       "b\r\nf 1/1/1 2//1 -3/-1 4 5\r\nusemtl x\r\nf -1 -2 -3\r\nl 1 2\r\n");
  save("obj", "bad_index", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  save("obj", "nan", "v 0 0 0\nv nan 0 0\nv 0 1e999 0\nf 1 2 3\n");
  save("stl", "solid_binary",
       std::string("solid x") + std::string(73, ' ') + std::string("\x01\0\0\0", 4) + std::string(50, '\0'));
  save("stl", "one_line",
       "solid facet\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\nendsolid "
       "a\nsolid b\nendsolid\n");
  save("ply", "big_endian",
       std::string(
           "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty char x\nproperty short y\nproperty uchar "
           "z\nproperty list uchar int l\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n") +
           std::string("\x01\0\x02\x03\0\x05\0\0\x06\0\x01\0\0\x01\0\x03\0\x01\x02", 19));
  save("ply", "polygon",
       "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 5\nproperty float x\nproperty float "
       "y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int "
       "vertex_indices\n"
       "property list uchar float texcoord\nend_header\n0 0 0 0 0\n2 0 0 0 0\n1 1 0 1 1\n2 2 0 0 1\n0 2 0 1 0\n5 0 1 2 "
       "3 4 10 0 0 1 0 .5 .5 1 1 0 1\n");
  save("ply", "strips",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
       "tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 2 1 "
       "3\n");
  save("ply", "four_billion",
       "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty "
       "float z\nend_header\n0123");
  Bytes binary;
  test::put(binary, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f, std::uint16_t{2}, std::uint16_t{0}, 7.f, 8.f, 9.f);
  save(
      "glb", "sparse_strip",
      test::make_glb(
          R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1]},{"mesh":0,"rotation":[0,0,0.6,0.8],"scale":[1,2,3]}],
  "meshes":[{"primitives":[{"attributes":{"POSITION":0,"_X":1},"mode":5},{"attributes":{"POSITION":0},"mode":6}]}],
  "buffers":[{"byteLength":52}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":2},{"buffer":0,"byteOffset":40,"byteLength":12}],
  "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":2}}},{"bufferView":0,"componentType":5121,"normalized":true,"count":3,"type":"SCALAR"}]})",
          binary));
  save(
      "glb", "text",
      R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})");
  const ReadOptions options;
  for (const auto& [name, model] : {std::pair{"plain", &plain}, {"full", &full}, {"coloured", &coloured}}) {
    const Bytes bytes = write_model(*model, MeshFormat::three_mf, context);
    const MeshSource source(bytes, "seed", options, context);
    ZipArchive archive(source);
    save("three_mf_model", name, archive.read(*archive.find("3D/3dmodel.model"), 1 << 20));
  }
  const std::string mesh =
      "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1' "
      "z='0'/></vertices><triangles><triangle v1='0' v2='1' v3='2' pid='6' p1='0' p2='0' p3='0'/></triangles></mesh>";
  save("three_mf_model", "components",
       "<?xml version='1.0'?><!-- c --><model unit='inch'><resources><m:colorgroup id='6'><m:color "
       "color='#00FF00'/></m:colorgroup><object id='1' name='a&lt;&#65;'>" +
           mesh +
           "</object><object id='2'><components><component objectid='1' transform='0 1 0 -1 0 0 0 0 1 5 0 "
           "0'/><component objectid='1'/></components></object><object id='3' type='support'/></resources>"
           "<build><item objectid='2' transform='-1 0 0 0 1 0 0 0 1 0 0 0'/><item objectid='3'/></build></model>");
  save("three_mf_model", "circle",
       "<model><resources><object id='1'><components><component "
       "objectid='1'/></components></object></resources><build><item objectid='1'/></build></model>");
  save("mtl", "full", write_mtl(full));
  save("mtl", "options",
       "newmtl a b\nKd 0.5\nmap_Kd -s 1 1 1 -o 0.5 -clamp on -mm 0 1 a b.png\nnewmtl c\nKd spectral x\nmap_Kd x\n");
}

void add_other_seeds() {
  Grey16Image image{5, 3, 0.1, 0.1, std::vector<std::uint16_t>(15, 4711)};
  save("png16", "grey", write_png16(image));
  save("picture", "grey", write_png16(image));
  save("picture", "red", test::red_pixel_png());
  save("gcode", "laser",
       "%\nG21 G90 (mm)\nM4 S0\nG0 X1 Y2\nG1 X5 F600 S800 ; cut\nG2 X5 Y2 I1 J0\nG3 X1 Y1 R2\nM5\nG4 P1\n");
  save("gcode", "inches", "N10 G20 G91\nN20 G1 X.5 Y-1 F10\nG92 X0 Y0\nG53 G0 X0\nG28\nM3 S1000\nM0\nM30\n");
  save("egv", "cut",
       "Document type : LHYMICRO-GL file\nCreator-Software: x\n\n%0%0%0%0%\nIV2282531G001NRBS1EDzzzaaRLBzbFNSE-\n");
  save("egv", "bare", "IBzzaS1P\nICV2230141NRBS1EUaDFNSE-\n");
  save("rd", "end", std::string("\xd4\x09\xc6\xd4\x09\x8d\x89\x89\x89\x89\x89\x89"));
  save("job_message", "import",
       R"({"operation":"import","inputs":{"mesh":{"sample":"bunny","vertices":2000}},"outputs":["model.ply"]})");
  save("job_message", "hash",
       R"({"operation":"simplify","parameters":{"max_vertices":500},"inputs":{"mesh":{"sha256":")" +
           std::string(64, 'a') + R"(","file_name":"a.obj"}}})");
  save("json", "all", R"({"a":[1,-2.5e3,true,null,"\u00e4\ud83d\ude00"],"b":{"c":{}}})");
  save("json", "deep", std::string(70, '[') + std::string(70, ']'));
  save("craft_file", "setup", std::string("\0", 1) + R"({"sheet_mm":[240,260],"thickness_mm":1,"material":"PETG"})");
  save("craft_file", "points", "\x01sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm\n1,2,3,4,5,0.1\n4,5,6,7,8,0\n");
  save("craft_file", "thickness",
       "\x01sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,thickness_mm,thickness_sigma_mm\n1,2,3,4,5,0.9,0.05\n-9,0,,,,1.1,0\n");
  save("craft_file", "profile",
       "\x02"
       R"({"format":"formwright-machine-profile","version":1,"name":"a","parameters":{}})");
  save("craft_file", "segments",
       "\x03"
       R"({"punctures":[[0,0,1]],"loops":[[[0,0,0],[1,0,0]]],"start":[0,0,0]})");
  save(
      "craft_file", "design",
      "\x04"
      R"({"format":"formwright zippable design","version":1,"ribbon":{"boundary":[{"position_mm":[0,0,0],"flat_mm":[0,0]}],"triangles":[]},"pieces":[]})");
  save("craft_file", "pattern",
       "\x05"
       R"({"format":"formwright calibration pattern 1","marks":[],"patches":[]})");
  save("craft_file", "shading",
       "\x06"
       R"({"light_direction":[0,0,1],"light_distance_mm":100})");
  save("craft_file", "brightness", "\x07x_mm,y_mm,brightness,sigma\n0,0,1,0.1\n");
  save(
      "forest_scene", "two",
      std::string("\0", 1) +
          R"({"viewpoints":[{"eye_mm":[0,-600,60],"look_at_mm":[0,0,60],"width_mm":68,"sample":"bust","vertices":2000},{"eye_mm":[600,0,60],"look_at_mm":[0,0,60],"width_mm":90,"model":2,"direction":[0,0,-1],"up":[0,1,0]}],"pillars":[{"shape":"round","x_mm":-20,"y_mm":0,"width_mm":12,"height_mm":120},{"shape":"square","x_mm":10,"y_mm":5,"width_mm":14,"turn_deg":30,"height_mm":90},{"outline_mm":[[40,0],[50,0],[45,9]],"height_mm":100}]})");
  save("forest_scene", "screens",
       "\x01"
       R"({"viewpoints":[{"eye_mm":[0,-600,60],"look_at_mm":[0,0,60],"width_mm":68,"model":1}]})");
  save(
      "model_scene", "two",
      R"({"models":[{"sample":"cat","vertices":2000,"name":"Cat","size_mm":80,"turn_deg":[0,30,-5],"at_mm":[1.5,40,-20]},{"model":2}]})");
  save(
      "painting", "runs",
      R"({"vertices":12,"weight":[[0,3,4],[5,2,0.5]],"region":[[0,4,"on_base"],[4,2,3]],"thickness_mm":[[4,2,8]],"carve_depth_mm":[[4,2,-1]]})");
  save("painting", "lists", R"({"vertices":12,"weight":[1,1,1,2,1,1,1,1,1,1,1,1],"region":[0,0,1,0,0,2,0,0,0,0,0,0]})");
  save("png16", "red", test::red_pixel_png());
  save(
      "machine", "grbl",
      std::string("\0\x40", 2) +
          "G21G90\nM4S10\nG1X5F600\nGrbl 1.1h\r\nok\r\n<Idle|MPos:0,0,0|FS:0,0>\r\nok\r\nok\r\nALARM:1\r\nerror:3\r\n");
  save("machine", "marlin", std::string("\x01\x40") + "G1X5F600\nstart\nok\nResend: 2\nok\nok T:20 B:20\nError:kill\n");
  save("machine", "k40", std::string("\x02\x40") + "IBzzaS1P\nFNSE-\n\xff\xce\xff\xcf\xff\xec");
  save("machine", "ruida", std::string("\x03\x20") + "\xd4\x09\xc6\xd4\x09\x8d\x89\x89\x89\x89\x89\x89");
  save("machine_request", "load", R"({"n":3,"load":{"name":"job.gcode","sha256":")" + std::string(64, 'a') + R"("}})");
  save("machine_request", "command", R"({"command":{"do":"jog","x_mm":1,"speed_mm_per_s":10}})");
  save("machine_request", "open", R"({"open":{"controller":"grbl","baud":115200}})");
  save("document_pages", "grey", write_png16(image));
  save("document_pages", "page",
       "%PDF-1.4\n1 0 obj<</Type/Catalog/Pages 2 0 R>>endobj\n2 0 obj<</Type/Pages/Kids[3 0 R]/Count 1>>endobj\n3 0 "
       "obj<</Type/Page/Parent 2 0 R/MediaBox[0 0 595 842]/Rotate 90/UserUnit 2>>endobj\n"
       "trailer<</Root 1 0 R/Size 4>>\n%%EOF\n");
  // Version 1.1, ok, request 1; printer attributes: a media-col-database of A4 with its margins, a name that is no
  // UTF-8, a range of copies.
  const auto attribute = [](char tag, std::string_view name, std::string_view value) {
    return std::string(1, tag) + '\0' + static_cast<char>(name.size()) + std::string(name) + '\0' +
           static_cast<char>(value.size()) + std::string(value);
  };
  const auto integer = [](int value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
    return bytes;
  };
  const auto member = [&](std::string_view name, char tag, std::string_view value) {
    return attribute(0x4a, "", name) + attribute(tag, "", value);
  };
  const std::string size = member("media-size", 0x34, "") + member("x-dimension", 0x21, integer(21000)) +
                           member("y-dimension", 0x21, integer(29700)) + attribute(0x37, "", "");
  const std::string media = size + member("media-left-margin", 0x21, integer(423)) +
                            member("media-top-margin", 0x21, integer(300)) + member("media-source", 0x44, "manual") +
                            attribute(0x37, "", "");
  const std::string begin("\x01\x01\x00\x00\x00\x00\x00\x01\x04", 9);
  save("printer_answer", "a4",
       begin + attribute(0x34, "media-col-database", "") + media + attribute(0x34, "media-col-ready", "") + media +
           attribute(0x41, "printer-make-and-model", "B\xfcro") + attribute(0x23, "printer-state", integer(4)) +
           attribute(0x44, "printer-state-reasons", "media-empty-error") +
           attribute(0x33, "copies-supported", integer(1) + integer(99)) +
           attribute(0x22, "color-supported", std::string_view("\x01", 1)) +
           attribute(0x23, "print-quality-supported", integer(4)) + "\x03");
  save("printer_answer", "old",
       begin + attribute(0x44, "media-supported", "iso_a4_210x297mm") + attribute(0x44, "", "na_letter_8.5x11in") +
           attribute(0x21, "media-left-margin-supported", integer(500)) +
           attribute(0x44, "media-source-supported", "by-pass-tray") + "\x03");
  save("upload_answer", "octoprint",
       std::string("\x01\x01\x01") +
           R"({"done":true,"effectivePrint":true,"files":{"local":{"name":"mould.gcode","path":"mould.gcode"}}})");
  save("upload_answer", "octoprint_state",
       std::string("\x05\x00\x00", 3) +
           R"({"state":{"text":"Operational","flags":{"operational":true,"printing":false}}})");
  save("upload_answer", "octoprint_version", std::string("\x03\x00\x00", 3) + R"({"api":"0.1","server":"1.11.8"})");
  save("upload_answer", "moonraker",
       std::string("\x00\x01\x01", 3) + R"({"result":{"item":{"path":"mould.gcode"},"print_started":true}})");
  save(
      "upload_answer", "moonraker_state",
      std::string("\x02\x00\x00", 3) +
          R"({"result":{"klippy_state":"ready","moonraker_version":"v0.9","status":{"print_stats":{"state":"paused"}}}})");
  save("upload_answer", "refused", std::string("\x00\x05\x00", 3) + R"({"error":{"message":"\u00e4\u0000 busy"}})");
}

}  // namespace

Seeds fuzz_seeds() {
  Seeds made;
  seeds = &made;
  add_mesh_seeds();
  add_other_seeds();
  for (const auto& [name, text] : svg_seeds()) save("svg", name, text);
  return made;
}

}  // namespace formwright::fuzz
