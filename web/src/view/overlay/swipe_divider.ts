// SPDX-License-Identifier: GPL-3.0-or-later
// The blue line between original and relief: a slider over the width of what is shown.

/** Extent of the shown object on the viewport, CSS pixels. */
export interface Extent {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** The line reaches this far beyond the object, px. */
const OVERHANG = 14;
/** The divider keeps this far from the viewport's edges, so that it can always be caught. */
const EDGE = 12;

/** Left end and length of the divider's way: the object as far as it is visible. */
export function swipeRange(extent: Extent, width: number): { from: number; length: number } {
  const from = Math.min(Math.max(extent.left, EDGE), Math.max(EDGE, width - 2 * EDGE));
  const to = Math.max(Math.min(extent.right, width - EDGE), from + 1);
  return { from, length: to - from };
}

export class SwipeDivider {
  readonly element = document.createElement('div');
  private way = { from: 0, length: 1 };
  private position = 0.5;

  constructor(
    private readonly root: HTMLElement,
    private readonly onChange: (position: number) => void,
  ) {
    const { element } = this;
    element.className = 'fw-swipe';
    element.tabIndex = 0;
    element.setAttribute('role', 'slider');
    element.setAttribute('aria-label', 'Swipe between original and relief');
    element.setAttribute('aria-valuemin', '0');
    element.setAttribute('aria-valuemax', '100');
    element.innerHTML =
      '<div class="grip"><svg viewBox="0 0 16 16" aria-hidden="true"><path d="M6 4L2 8l4 4M10 4l4 4-4 4"/></svg></div>';
    element.addEventListener('pointerdown', this.press);
    element.addEventListener('keydown', this.key);
  }

  /** Returns the line's x, px. */
  place(extent: Extent, width: number, height: number, position: number): number {
    this.way = swipeRange(extent, width);
    this.position = position;
    const x = this.way.from + position * this.way.length;
    const top = Math.max(0, extent.top - OVERHANG);
    const bottom = Math.min(height, extent.bottom + OVERHANG);
    this.element.style.transform = `translate(${x.toFixed(2)}px, ${top.toFixed(2)}px)`;
    this.element.style.height = `${Math.max(48, bottom - top).toFixed(2)}px`;
    const percent = Math.round(100 * position);
    this.element.setAttribute('aria-valuenow', String(percent));
    this.element.setAttribute(
      'aria-valuetext',
      `${percent} percent original, ${100 - percent} percent relief`,
    );
    return x;
  }

  private readonly press = (event: PointerEvent): void => {
    if (event.button !== 0) return;
    event.preventDefault();
    event.stopPropagation();
    this.element.focus({ preventScroll: true });
    this.element.setPointerCapture(event.pointerId);
    const grabbed =
      event.clientX -
      this.root.getBoundingClientRect().left -
      (this.way.from + this.position * this.way.length);
    const drag = (e: PointerEvent): void => {
      const x = e.clientX - this.root.getBoundingClientRect().left - grabbed;
      this.set((x - this.way.from) / this.way.length);
    };
    const release = (): void => {
      this.element.removeEventListener('pointermove', drag);
      this.element.removeEventListener('pointerup', release);
      this.element.removeEventListener('pointercancel', release);
    };
    this.element.addEventListener('pointermove', drag);
    this.element.addEventListener('pointerup', release);
    this.element.addEventListener('pointercancel', release);
  };

  private readonly key = (event: KeyboardEvent): void => {
    // The page's rule for sliders: arrows 1 %, with Shift 10 %.
    const step = event.shiftKey ? 0.1 : 0.01;
    const to: Record<string, number> = {
      ArrowRight: this.position + step,
      ArrowUp: this.position + step,
      ArrowLeft: this.position - step,
      ArrowDown: this.position - step,
      PageUp: this.position + 0.1,
      PageDown: this.position - 0.1,
      Home: 0,
      End: 1,
    };
    const next = to[event.key];
    if (next === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    this.set(next);
  };

  private set(position: number): void {
    this.onChange(Math.min(1, Math.max(0, position)));
  }
}
