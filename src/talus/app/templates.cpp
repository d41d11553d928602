#include "talus/app/templates.hpp"

#include <cstddef>

// The build writes TALUS_TEMPLATES, a line TALUS_TEMPLATE(name, "file") for each and a line
// TALUS_TEMPLATE_MAP(name, "path", "file") for each map; the assembler includes the bytes.
#define TALUS_BYTES(name, file)                                                                      \
  asm(".pushsection .rodata\ntalus_template_" #name ":\n.incbin \"" file "\"\ntalus_template_" #name \
      "_end:\n.popsection\n");                                                                       \
  extern "C" const char talus_template_##name[], talus_template_##name##_end[];
#define TALUS_TEMPLATE(name, file) TALUS_BYTES(name, file)
#define TALUS_TEMPLATE_MAP(name, path, file) TALUS_BYTES(name, file)
#include TALUS_TEMPLATES
#undef TALUS_TEMPLATE
#undef TALUS_TEMPLATE_MAP

#define TALUS_VIEW(name) \
  { talus_template_##name, std::size_t(talus_template_##name##_end - talus_template_##name) }

namespace talus {

std::span<const Template> templates() {
#define TALUS_TEMPLATE(name, file) {#name, TALUS_VIEW(name)},
#define TALUS_TEMPLATE_MAP(name, path, file)
  static const Template all[] = {
#include TALUS_TEMPLATES
  };
#undef TALUS_TEMPLATE
#undef TALUS_TEMPLATE_MAP
  return all;
}

std::span<const TemplateMap> template_maps() {
#define TALUS_TEMPLATE(name, file)
#define TALUS_TEMPLATE_MAP(name, path, file) {path, TALUS_VIEW(name)},
  static const TemplateMap all[] = {
#include TALUS_TEMPLATES
  };
#undef TALUS_TEMPLATE
#undef TALUS_TEMPLATE_MAP
  return all;
}

}  // namespace talus
