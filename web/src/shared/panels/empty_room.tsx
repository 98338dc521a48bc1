// SPDX-License-Identifier: GPL-3.0-or-later
// A room with nothing in it: what it starts from, the model that the project has already, files and samples.
import type { ComponentChildren } from 'preact';
import type { Sample } from '../../jobs/contract';
import { Button } from '../../ui';
import { titleOf } from '../session/craft_document';
import type { ModelRoom } from '../session/opened_model';
import type { CraftDocument } from '../session/craft_document';
import { Gallery } from './gallery';
import './empty_room.css';

export interface EmptyRoomProps {
  /** One sentence: what is made here, and of what. */
  readonly what: ComponentChildren;
  /** Buttons; the first one filled. */
  readonly children: ComponentChildren;
  /** Further down: samples, hints. */
  readonly below?: ComponentChildren;
}

export function EmptyRoom({ what, children, below }: EmptyRoomProps) {
  return (
    <div class="empty-room">
      <p>{what}</p>
      <div class="empty-room-actions">{children}</div>
      {below}
    </div>
  );
}

export interface EmptyModelRoomProps<D extends CraftDocument> {
  readonly session: ModelRoom<D>;
  readonly what: string;
  readonly samples: readonly Sample[];
  readonly onChooseFile: () => void;
  /** Further buttons. */
  readonly children?: ComponentChildren;
}

/** The same for a room that makes something of a model. */
export function EmptyModelRoom<D extends CraftDocument>(props: EmptyModelRoomProps<D>) {
  const { session, samples } = props;
  const [there, ...others] = session.model.elsewhere.value;
  return (
    <EmptyRoom
      what={props.what}
      below={
        samples.length > 0 ? (
          <>
            <h2>Or start from a sample</h2>
            <Gallery
              samples={samples}
              onOpen={(sample, title) => void session.model.openSample(sample, title)}
            />
          </>
        ) : null
      }
    >
      {there ? (
        <Button kind="filled" icon="check" onClick={() => session.model.take(there)}>
          Use {titleOf(there.source)}
        </Button>
      ) : null}
      {others.map((model) => (
        <Button key={model.mesh.blob} onClick={() => session.model.take(model)}>
          Use {titleOf(model.source)}
        </Button>
      ))}
      <Button kind={there ? 'outlined' : 'filled'} icon="upload" onClick={props.onChooseFile}>
        Open a model
      </Button>
      {props.children}
    </EmptyRoom>
  );
}
