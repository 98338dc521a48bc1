// SPDX-License-Identifier: GPL-3.0-or-later
// What is printed, at scale, with the pages that lie over it.
import { useEffect, useState } from 'preact/hooks';
import { roomsOver } from '../../machines/printing/paper';
import type { PrintSession } from './print_session';

const mediaTypes: Readonly<Record<string, string>> = {
  png: 'image/png',
  jpg: 'image/jpeg',
  svg: 'image/svg+xml',
};

export function PagePreview({ session }: { readonly session: PrintSession }) {
  const { fileName, bytes, title } = session.printable;
  const [url, setUrl] = useState<string | null>(null);
  useEffect(() => {
    const type = mediaTypes[fileName.split('.').at(-1) ?? ''];
    if (type === undefined) return;
    const made = URL.createObjectURL(new Blob([bytes], { type }));
    setUrl(made);
    return () => URL.revokeObjectURL(made);
  }, [bytes]);
  const layout = session.laid.value?.layout;
  if (!layout) return null;
  const overlap = Number(session.value('overlap_mm') ?? 0);
  const mirrored = session.value('mirrored') === true;
  const [width, height] = layout.size_mm;
  const [room_x, room_y] = layout.room_mm;
  const rooms = roomsOver(layout, overlap);
  const margin_x = (layout.page_mm[0] - room_x) / 2;
  const margin_y = (layout.page_mm[1] - room_y) / 2;
  const last = rooms.at(-1) ?? { x_mm: 0, y_mm: 0 };
  const box = [-margin_x, -margin_y, last.x_mm + room_x + 2 * margin_x, last.y_mm + room_y + 2 * margin_y];
  const text_mm = Math.max(box[2] ?? 0, box[3] ?? 0) / 22;
  const words = layout.pages === 1 ? 'one page' : `${layout.columns} by ${layout.rows} pages`;
  return (
    <svg class="page-preview" viewBox={box.join(' ')} role="img" aria-label={`${title} on ${words}`}>
      {rooms.map(({ x_mm, y_mm }) => (
        <rect
          class="page-paper"
          key={`${x_mm} ${y_mm}`}
          x={x_mm - margin_x}
          y={y_mm - margin_y}
          width={room_x + 2 * margin_x}
          height={room_y + 2 * margin_y}
        />
      ))}
      {url ? (
        <image
          href={url}
          width={width}
          height={height}
          transform={mirrored ? `translate(${width} 0) scale(-1 1)` : undefined}
          preserveAspectRatio="none"
        />
      ) : null}
      {rooms.map(({ x_mm, y_mm }, i) => (
        <g key={`${x_mm} ${y_mm}`}>
          <rect class="page-room" x={x_mm} y={y_mm} width={room_x} height={room_y} />
          {rooms.length > 1 ? (
            <text class="page-number" x={x_mm + text_mm / 2} y={y_mm + 1.2 * text_mm} font-size={text_mm}>
              {i + 1}
            </text>
          ) : null}
        </g>
      ))}
    </svg>
  );
}
