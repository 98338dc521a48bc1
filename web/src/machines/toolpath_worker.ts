// SPDX-License-Identifier: GPL-3.0-or-later
// Reads tool paths off the page's thread: a mill's has a million points.
import { readGcodePath } from './gcode_path';
import { detailsOf } from './path_detail';
import type { ToolPath, ToolPathPart } from './toolpath';
import { readToolPath } from './toolpath';
import type { ToolPathReply, ToolPathRequest } from './toolpath_messages';

/** Numbers side by side, which are handed over rather than copied. */
const packed = (part: ToolPathPart): ToolPathPart => ({
  ...part,
  points_mm: Float64Array.from(part.points_mm),
  times_s: Float64Array.from(part.times_s),
  lines: Uint32Array.from(part.lines),
});

function read(request: ToolPathRequest): ToolPath {
  const text = new TextDecoder().decode(request.bytes);
  const raw =
    request.kind === 'toolpath'
      ? readToolPath(text)
      : readGcodePath(text, request.bed_mm, request.power_max_s);
  const toolPath = { ...raw, paths: raw.paths.map(packed) };
  return { ...toolPath, details: detailsOf(toolPath) };
}

self.onmessage = ({ data }: MessageEvent<ToolPathRequest>) => {
  const reply = (message: ToolPathReply, transfer: Transferable[] = []) =>
    self.postMessage(message, { transfer });
  try {
    const toolPath = read(data);
    const numbers = toolPath.paths.flatMap(({ points_mm, times_s, lines }) => [points_mm, times_s, lines]);
    const kept = (toolPath.details ?? []).flatMap((detail) => detail.kept);
    const buffers = [...numbers, ...kept].flatMap((array) =>
      ArrayBuffer.isView(array) ? [array.buffer] : [],
    );
    reply({ id: data.id, toolPath }, buffers as ArrayBuffer[]);
  } catch (thrown) {
    reply({ id: data.id, error: thrown instanceof Error ? thrown.message : String(thrown) });
  }
};
