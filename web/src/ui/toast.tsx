// SPDX-License-Identifier: GPL-3.0-or-later
import { signal } from '@preact/signals';

const current = signal<{ text: string; assertive: boolean } | null>(null);
let timer: ReturnType<typeof setTimeout> | undefined;

/** One sentence that goes by itself. What needs an answer is a Note or a Dialog. */
export function toast(text: string, assertive = false): void {
  clearTimeout(timer);
  current.value = { text, assertive };
  timer = setTimeout(() => (current.value = null), Math.max(4000, 60 * text.length));
}

export function ToastLayer() {
  const shown = current.value;
  return (
    <div class="toasts">
      <div role="status" aria-live="polite">
        {shown && !shown.assertive ? <p class="toast">{shown.text}</p> : null}
      </div>
      <div role="alert">{shown?.assertive ? <p class="toast">{shown.text}</p> : null}</div>
    </div>
  );
}
