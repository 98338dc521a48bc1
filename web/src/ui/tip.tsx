// SPDX-License-Identifier: GPL-3.0-or-later
// One tip for the whole page: help on hover or keyboard focus. What it says is also in the description of
// the control it belongs to, so it is hidden from screen readers.
import { signal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';

interface Tip {
  readonly text: string;
  readonly anchor: DOMRect;
  readonly side: 'left' | 'below';
}

const shown = signal<Tip | null>(null);
let timer: ReturnType<typeof setTimeout> | undefined;
const hoverDelay_ms = 350;

function showTip(element: Element, text: string, side: Tip['side'], delay_ms = 0): void {
  clearTimeout(timer);
  const show = () => {
    if (element.isConnected) shown.value = { text, anchor: element.getBoundingClientRect(), side };
  };
  if (delay_ms > 0) timer = setTimeout(show, delay_ms);
  else show();
}

export function hideTip(): void {
  clearTimeout(timer);
  shown.value = null;
}

/** Handlers that show `text` beside an element on hover and on keyboard focus. */
export function tipHandlers(text: string | undefined, side: Tip['side'] = 'below') {
  if (!text) return {};
  return {
    onPointerEnter: (event: PointerEvent) => {
      if (event.pointerType === 'mouse') showTip(event.currentTarget as Element, text, side, hoverDelay_ms);
    },
    onPointerLeave: hideTip,
    onFocus: (event: FocusEvent) => {
      const element = event.currentTarget as Element;
      if (element.matches(':focus-visible')) showTip(element, text, side);
    },
    onBlur: hideTip,
    onPointerDown: hideTip,
  };
}

export function TipLayer() {
  const tip = shown.value;
  const ref = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => {
    const element = ref.current;
    if (element === null || tip === null) return;
    // In the browser's top layer, or a modal dialog would lie over it.
    if (!element.matches(':popover-open')) element.showPopover();
    const { width, height } = element.getBoundingClientRect();
    const { anchor } = tip;
    const left = tip.side === 'left' ? anchor.left - width - 14 : anchor.left + anchor.width / 2 - width / 2;
    const beside = left >= 8 || tip.side === 'below';
    const top =
      tip.side === 'left' && beside ? anchor.top + anchor.height / 2 - height / 2 : anchor.bottom + 8;
    const lowest = window.innerHeight - height - 8;
    element.style.left = `${Math.max(8, Math.min(beside ? left : anchor.left, window.innerWidth - width - 8))}px`;
    element.style.top = `${top > lowest ? Math.max(8, Math.min(lowest, anchor.top - height - 8)) : Math.max(8, top)}px`;
    element.style.visibility = 'visible';
  }, [tip]);
  if (tip === null) return null;
  return (
    <div ref={ref} class="tip" popover="manual" aria-hidden="true" key={tip.text}>
      {tip.text}
    </div>
  );
}
