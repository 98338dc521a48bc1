// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that a relief is worked into, from a file.
import { useRef } from 'preact/hooks';
import { Button } from '../../../ui';
import type { ReliefSession } from '../relief_session';

export function BaseFile({ session }: { readonly session: ReliefSession }) {
  const input = useRef<HTMLInputElement>(null);
  const { base } = session.document.value;
  const formats = session.operation.value?.inputs.find(({ name }) => name === 'base_mesh')?.extensions ?? [];
  if (formats.length === 0) return null;
  const choose = () => input.current?.click();
  return (
    <>
      {base ? (
        <div class="row">
          <strong class="grow clip">{base.file_name}</strong>
          <Button onClick={choose}>Replace</Button>
          <Button onClick={() => session.dropBase()}>Remove</Button>
        </div>
      ) : (
        <div class="row">
          <Button onClick={choose} title="A surface in millimetres: x right, y up, z towards the viewer">
            Base from a file
          </Button>
        </div>
      )}
      <input
        ref={input}
        type="file"
        hidden
        aria-label="File of the base"
        accept={formats.map((extension) => `.${extension}`).join(',')}
        onChange={({ currentTarget }) => {
          const file = currentTarget.files?.[0];
          currentTarget.value = '';
          if (file) void session.openBase(file);
        }}
      />
    </>
  );
}
