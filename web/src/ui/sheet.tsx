// SPDX-License-Identifier: GPL-3.0-or-later
import type { ComponentChildren } from 'preact';
import { useState } from 'preact/hooks';

/** The inspector: a column beside the view; on a phone a sheet with a handle that makes it tall or low. */
export function Sheet({ label, children }: { label: string; children: ComponentChildren }) {
  const [size, setSize] = useState<'low' | 'middle' | 'tall'>('middle');
  const [start, setStart] = useState<number | null>(null);
  const order = ['low', 'middle', 'tall'] as const;
  const move = (by: number) => setSize(order[Math.min(2, Math.max(0, order.indexOf(size) + by))] ?? 'middle');
  return (
    <aside class={`side sheet-${size}`} aria-label={label}>
      <button
        type="button"
        class="sheet-handle"
        aria-label={size === 'tall' ? 'Make this panel lower' : 'Make this panel taller'}
        aria-expanded={size === 'tall'}
        onPointerDown={(event) => {
          setStart(event.clientY);
          event.currentTarget.setPointerCapture(event.pointerId);
        }}
        onPointerUp={(event) => {
          const by = start === null ? 0 : start - event.clientY;
          setStart(null);
          if (Math.abs(by) > 24) {
            event.preventDefault();
            move(Math.sign(by));
          } else setSize(size === 'tall' ? 'middle' : size === 'middle' ? 'tall' : 'middle');
        }}
        onKeyDown={(event) => {
          if (event.key === 'ArrowUp') move(1);
          else if (event.key === 'ArrowDown') move(-1);
          else if (event.key === 'Enter' || event.key === ' ') setSize(size === 'tall' ? 'middle' : 'tall');
          else return;
          event.preventDefault();
        }}
      />
      {children}
    </aside>
  );
}
