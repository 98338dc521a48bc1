// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets to be looked at: one alone or all beside each other, zoomed and dragged.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { Button, IconButton } from '../../../ui';
import type { Size } from './plane_view';
import { arranged, usable } from './plane_view';
import type { Sheet } from './sheet_drawing';
import { usePlaneView } from './use_plane_view';

const gap_mm = 20;

export interface SheetStageProps {
  readonly sheets: readonly Sheet[];
  /** What is shown, for those who do not see it. */
  readonly words: string;
  readonly label: string;
  /** "Sheet 2, colour 1"; counted from 0. */
  readonly nameOf: (sheet: number) => string;
}

function usePaneSize() {
  const ref = useRef<HTMLDivElement>(null);
  const [size, setSize] = useState<Size>({ width: 0, height: 0 });
  useEffect(() => {
    const element = ref.current;
    if (element === null) return undefined;
    const resize = new ResizeObserver(() =>
      setSize({ width: element.clientWidth, height: element.clientHeight }),
    );
    resize.observe(element);
    return () => resize.disconnect();
  }, []);
  return { ref, size };
}

export function SheetStage({ sheets, words, label, nameOf }: SheetStageProps) {
  const { ref, size: pane } = usePaneSize();
  const [chosen, setChosen] = useState<number | null>(null);
  const one = chosen !== null && chosen < sheets.length ? chosen : null;
  const shown = useMemo(
    () =>
      sheets
        .map((sheet, number) => ({ sheet, number }))
        .filter(({ number }) => one === null || number === one),
    [sheets, one],
  );
  const sizes = shown.map(({ sheet }) => ({ width: sheet.width_mm, height: sheet.height_mm }));
  const content = arranged(sizes, gap_mm, pane);
  const { view, isFitted, fit, zoom, handlers } = usePlaneView(shown, content, pane);
  const step = (by: number) =>
    setChosen(
      one === null ? (by > 0 ? 0 : sheets.length - 1) : Math.min(sheets.length - 1, Math.max(0, one + by)),
    );
  const keys = (event: KeyboardEvent) => {
    const steps: Record<string, () => void> = {
      PageUp: () => step(-1),
      PageDown: () => step(1),
      Home: () => setChosen(null),
    };
    const action = sheets.length > 1 && !event.ctrlKey && !event.altKey && !event.metaKey && steps[event.key];
    if (action) action();
    else if (!handlers.onKey(event)) return;
    event.preventDefault();
    event.stopPropagation();
  };
  const [left, top] = [view.x, view.y];
  const corners = content.places;
  return (
    <>
      <div
        ref={ref}
        class={isFitted ? 'sheet-stage' : 'sheet-stage zoomed'}
        tabIndex={0}
        role="group"
        aria-label={label}
        aria-keyshortcuts="+ - 0 PageUp PageDown Home"
        onKeyDown={keys}
        onWheel={handlers.onWheel}
        onDblClick={handlers.onDblClick}
        onPointerDown={handlers.onPointerDown}
        onPointerMove={handlers.onPointerMove}
        onPointerUp={handlers.onPointerUp}
        onPointerCancel={handlers.onPointerCancel}
      >
        {usable(pane) ? (
          <svg
            role="img"
            aria-label={words}
            width={pane.width}
            height={pane.height}
            viewBox={`${left} ${top} ${pane.width / view.scale} ${pane.height / view.scale}`}
          >
            {shown.map(({ sheet, number }, i) => (
              <g key={number} transform={`translate(${(corners[i] ?? [0, 0]).join(' ')})`}>
                <SheetLines sheet={sheet} />
              </g>
            ))}
          </svg>
        ) : null}
      </div>
      <div class="sheet-tools" role="group" aria-label="Look at the sheets">
        {sheets.length > 1 ? (
          <>
            <IconButton
              icon="chevronLeft"
              label="Previous sheet"
              keys="PageUp"
              disabled={one === 0}
              onClick={() => step(-1)}
            />
            <span class="sheet-name" role="status">
              {one === null ? `All ${sheets.length}` : `${nameOf(one)} of ${sheets.length}`}
            </span>
            <IconButton
              icon="chevronRight"
              label="Next sheet"
              keys="PageDown"
              disabled={one === sheets.length - 1}
              onClick={() => step(1)}
            />
            <Button
              size="small"
              disabledReason={one === null ? 'All sheets are shown' : undefined}
              onClick={() => setChosen(null)}
            >
              All
            </Button>
          </>
        ) : null}
        <span class="grow" />
        <IconButton
          icon="minus"
          label="Zoom out"
          keys="-"
          disabled={isFitted}
          onClick={() => zoom(1 / 1.5)}
        />
        <IconButton icon="plus" label="Zoom in" keys="+" onClick={() => zoom(1.5)} />
        <IconButton icon="frame" label="Fit" keys="0" disabled={isFitted} onClick={fit} />
      </div>
    </>
  );
}

/** All lines are as wide as on the screen: a laser's hairlines are not to be seen at a fifth of their size. */
function SheetLines({ sheet }: { readonly sheet: Sheet }) {
  return useMemo(
    () => (
      <>
        <rect class="sheet-paper" width={sheet.width_mm} height={sheet.height_mm} />
        {sheet.lines.map(({ layer, colour, d }) => (
          <path key={layer} d={d} stroke={colour} />
        ))}
      </>
    ),
    [sheet],
  );
}
