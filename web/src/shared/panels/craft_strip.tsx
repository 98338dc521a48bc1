// SPDX-License-Identifier: GPL-3.0-or-later
// The job strip of a room that previews as one goes and solves in full when asked.
import { JobStrip, useLasting } from '../../ui';
import type { CraftDocument, CraftResult } from '../session/craft_document';
import type { PreviewingRoom, ShownWork } from '../session/previews';
import { Results } from './results';
import type { RunningActivity } from './room_strip';
import { previewLine, RunningStrip } from './room_strip';

export interface CraftStripProps<D extends CraftDocument, S extends ShownWork> {
  readonly session: PreviewingRoom<D, S>;
  /** Titles of what runs; then of a full result, of nothing made yet, and of what could not be made. */
  readonly titles: Readonly<Record<RunningActivity['kind'] | 'done' | 'empty' | 'failed', string>>;
  readonly detailOf: (result: CraftResult) => string;
  /** What keeps the preview from being made, beside what the parameters' fields say. */
  readonly error?: string | undefined;
  /** Corners of triangles of what is shown. */
  readonly cornersOf: (shown: S) => number;
  readonly usualParameter: string;
  /** What tells one result from another: "11.1°", and a screen reader's "normal error 11.1°". */
  readonly figureOf: (result: CraftResult) => string;
  readonly figureName: string;
  readonly onRestore: (result: CraftResult, label: string) => void;
  /** Which may be returned to; left out: those made from what is open. */
  readonly results?: readonly CraftResult[];
}

export function CraftStrip<D extends CraftDocument, S extends ShownWork>(props: CraftStripProps<D, S>) {
  const { session, titles } = props;
  const activity = session.activity.value;
  const lasting = useLasting(activity.kind !== 'idle');
  const result = session.result.value;
  const shown = session.previews.shown.value;
  if (lasting && activity.kind !== 'idle')
    return <RunningStrip activity={activity} titles={titles} onCancel={() => session.cancel()} />;
  const state = result
    ? { state: 'done' as const, title: titles.done, detail: props.detailOf(result) }
    : previewLine({
        error: Object.values(session.fieldErrors.value)[0] ?? props.error,
        failed: titles.failed,
        empty: titles.empty,
        corners: shown && props.cornersOf(shown),
        seconds: session.previews.seconds.value,
        previewing: session.previews.running.value,
      });
  return (
    <JobStrip {...state}>
      <Results
        session={session}
        current={result}
        usualParameter={props.usualParameter}
        figureOf={(one) => {
          const short = props.figureOf(one);
          return { short, spoken: `${props.figureName} ${short}` };
        }}
        onChoose={props.onRestore}
        {...(props.results ? { results: props.results } : {})}
      />
    </JobStrip>
  );
}
