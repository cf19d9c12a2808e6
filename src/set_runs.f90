!> The motion of a set, its instants solved one after another and written as the command and the deck ask.
!>
!> The variants of a set with VARY cards: each is made when its turn comes, starts from the deck's own estimate and
!> leaves a row. So the row is the same whatever the others are, and memory does not grow with them. Where rows alone
!> are asked for, some are solved together. A variant that cannot be computed is a row that says so.
module set_runs
   use mechanism, only: settings_t, mechanism_t, instant_count, instant
   use independent, only: set_t, request_of, is_printed
   use structure, only: findings_t, find_structure, faults_text
   use failures, only: status_flagged
   use deck, only: build_variant
   use deck_variants, only: variation_t
   use progress, only: show_progress, progress_t
   use listing, only: layout_t, new_layout, listing_state_t, listing_instant, listing_end, listing_broken_off
   use solver_log, only: log_head, log_instant
   use answers, only: answers_t, new_answers, take_instant, put_answers
   use variant_rows, only: summary_t, variant_row_t, new_summary, new_row, fill_row, note_flag
   use variant_tables, only: summary_head, summary_row, put_variant, put_variant_heads, put_note_of_shares, &
      put_variant_row, put_variants_end
   use numerals, only: whole
   use lane_runs, only: lane_run_t, renew_run, begin_run, run_lanes, width
   use lane_state, only: lanes_t
   use command_line, only: options_t, out_listing, out_csv, out_log, out_summary, out_table, out_plot_table
   use outputs, only: is_over, write_parts, outputs_t
   use text_output, only: output_t
   use csv, only: csv_instant
   use table, only: table_t, table_instant
   use phrases, only: phrase_t, say_broken_off, say_broken_variant
   use drawing, only: drawing_t
   use convergence, only: convergence_t
   use branch_certificate, only: branch_t
   use points, only: strides, any_due
   use motion_proof, only: holds
   use set_motion, only: new_set_motion, has_words
   use set_analysis, only: set_analysis_t, begin_analysis, advance_set, sample_set, sense_set, prove_set, &
      set_record, set_errors, set_closure_error, set_closing_diagnostics
   implicit none
   private
   public :: run_variants, are_together, writers_t, run_motion, break_off

   !> The job's outputs, and what they keep from instant to instant.
   type, extends(outputs_t) :: writers_t
      type(progress_t) :: progress
      integer :: first = 1, last = 0                !< the sets that were read
      type(layout_t) :: layout                      !< of the listing of the set at hand
      type(table_t) :: table                        !< of the set at hand
      logical :: varies = .false.                   !< the deck has VARY cards
      type(variation_t), allocatable :: variations(:)   !< of the sets that have them
      type(drawing_t), allocatable :: drawings(:)   !< (first:last)
   end type writers_t

contains

   !> Solves and writes the variants `first` to `last` of `v`, those of set number `i`, `m`.
   subroutine run_variants(options, m, i, first, last, v, o, status)
      type(options_t), intent(in) :: options
      class(set_t), intent(in) :: m
      integer, intent(in) :: i, first, last
      type(variation_t), intent(inout) :: v
      type(writers_t), intent(inout) :: o
      integer, intent(inout) :: status
      type(layout_t) :: layout
      type(summary_t) :: summary
      logical :: full
      integer :: n

      n = first
      full = is_printed(m)
      layout = new_layout(m)
      summary = new_summary(m, layout, v)
      if (o%asked(out_summary) .and. first == 1) call summary_head(o%files(out_summary, 0), summary)
      if (o%asked(out_listing) .and. first == 1 .and. .not. full) then
         call put_note_of_shares(o%files(out_listing, 0), m)
         call put_variant_heads(o%files(out_listing, 0), summary)
      end if
      if (are_together(m, full, o)) then
         call run_together()
      else
         call run_each()
      end if
      if (n <= last) call break_off(o, m, say_broken_variant, n - 1)
      if (n > v%total .and. o%asked(out_listing)) call put_variants_end(o%files(out_listing, 0), m)

   contains

      !> Solves and writes the variants `n` to `last` of `v` one after another; `n`: the first that is not written.
      subroutine run_each()
         type(variant_row_t) :: row
         type(mechanism_t) :: variant

         do while (n <= last)
            row = new_row(summary, v, n)
            if (o%asked(out_listing) .and. full) &
               call put_variant(o%files(out_listing, 0), layout, summary, m, row)
            call run_variant(variant, row)
            if (is_over(o, i)) return
            if (o%asked(out_listing) .and. full) call put_variant_heads(o%files(out_listing, 0), summary)
            call write_row(row)
            n = n + 1
         end do
      end subroutine run_each

      !> The same of rows alone, as many variants at a time as there are lanes.
      subroutine run_together()
         ! Of a class, so that the compiler calls what makes and frees one, and does not write it out for each use.
         class(lane_run_t), allocatable :: runs(:)
         type(lanes_t) :: lanes
         integer :: k, count

         allocate (lane_run_t :: runs(width))
         do while (n <= last)
            count = min(width, last - n + 1)
            do k = 1, count
               runs(k)%row = new_row(summary, v, n + k - 1)
               call start(runs(k))
            end do
            call run_lanes(runs(:count), lanes)
            do k = 1, count
               if (is_over(o, i)) return
               if (runs(k)%row%rejected == '') call fill_row(summary, runs(k)%s%now, runs(k)%asked, runs(k)%row)
               if (runs(k)%row%rejected /= '') call fill_row(summary, m, runs(k)%asked, runs(k)%row)
               call write_row(runs(k)%row)
               n = n + 1
            end do
         end do
      end subroutine run_together

      !> Makes the variant of `v` whose row `r` has, unless it is refused.
      subroutine start(r)
         type(lane_run_t), intent(inout) :: r
         type(findings_t) :: findings
         logical :: is_done

         call build_variant(v, r%row%number, r%m, r%row%rejected)
         r%is_over = r%row%rejected /= ''
         if (r%is_over) return
         call renew_run(r, is_done)
         if (is_done) return
         call check_variant(r%m, findings, r%row)
         r%is_over = r%row%rejected /= ''
         if (.not. r%is_over) call begin_run(r, findings)
      end subroutine start

      !> Finds the structure of the `variant` whose `row` this is; what the checks say stands in the row.
      subroutine check_variant(variant, findings, row)
         type(mechanism_t), intent(in) :: variant
         type(findings_t), intent(out) :: findings
         type(variant_row_t), intent(inout) :: row
         character(:), allocatable :: faults

         findings = find_structure(variant)
         faults = faults_text(variant, findings, variant%set_number)
         row%rejected = faults(:index(faults//new_line('a'), new_line('a')) - 1)
      end subroutine check_variant

      !> Solves and writes the variant of `v` whose `row` this is, of set number `i`: it is `variant` now. `full`: its
      !> tables are asked for.
      subroutine run_variant(variant, row)
         type(mechanism_t), intent(inout) :: variant
         type(variant_row_t), intent(inout) :: row
         type(findings_t) :: findings
         type(set_analysis_t) :: a
         type(answers_t) :: asked

         call build_variant(v, row%number, variant, row%rejected)
         if (row%rejected == '') call check_variant(variant, findings, row)
         if (row%rejected == '') then
            call new_set_motion(variant, a%now, findings)
            if (full .and. o%asked(out_listing)) o%layout = new_layout(a%now)
            if (o%asked(out_log)) call log_head(o%files(out_log, 0), variant, options%errors)
            call run_motion(options, a, i, findings, full, o, row, asked)
            call fill_row(summary, a%now, asked, row)
         else
            call fill_row(summary, m, asked, row)
         end if
      end subroutine run_variant

      !> Writes the `row` of a variant.
      subroutine write_row(row)
         type(variant_row_t), intent(in) :: row

         if (o%asked(out_summary)) call summary_row(o%files(out_summary, 0), summary, m, row)
         if (o%asked(out_listing)) call put_variant_row(o%files(out_listing, 0), layout, summary, m, row)
         call write_parts(o)
         if (row%flagged + row%unproved > 0 .or. row%rejected /= '') status = status_flagged
         if (o%progress%shown) call show_progress(o%progress, 'SET '//whole(i)//': VARIANT', row%number, v%total)
      end subroutine write_row
   end subroutine run_variants

   !> Whether rows alone are asked of the variants of the set `m`, which `prints` tables or not: then as many are solved
   !> together as there are lanes.
   pure logical function are_together(m, prints, o)
      class(settings_t), intent(in) :: m
      logical, intent(in) :: prints
      class(outputs_t), intent(in) :: o

      are_together = m%variants > 0 .and. .not. (prints .or. m%proves .or. o%asked(out_csv) .or. o%asked(out_log))
   end function are_together

   !> Solves and writes set number `i`, a%now, instant by instant; `full`: its tables too. `row`: how many instants are
   !> solved and flagged, and the first of those; `asked`: the answers to its cards.
   subroutine run_motion(options, a, i, findings, full, o, row, asked)
      type(options_t), intent(in) :: options
      type(set_analysis_t), intent(inout) :: a
      integer, intent(in) :: i
      type(findings_t), intent(inout) :: findings
      logical, intent(in) :: full
      type(writers_t), intent(inout) :: o
      type(variant_row_t), intent(inout) :: row
      type(answers_t), intent(out) :: asked
      type(listing_state_t) :: state
      integer, allocatable :: every(:)
      logical :: lists, due
      integer :: k, n

      call begin_analysis(a, findings)
      lists = full .and. o%asked(out_listing)
      if (o%asked(out_listing) .or. a%now%variants > 0) call new_answers(a, lists, asked)
      every = strides([(request_of(a%now, n), n=1, size(a%now%rows))])
      do k = 0, instant_count(a%now) - 1
         call advance_set(a, instant(a%now, k))
         due = any_due(a%now, every, k)
         if (a%now%proves) then
            call prove_set(a, due)
            if (.not. all(holds(a%now%proofs(1:)))) row%unproved = row%unproved + 1
         end if
         call note_flag(row, a)
         call write_instant(due)
         call take_instant(asked, a, k, due)
         if (o%progress%shown .and. a%now%variants == 0) &
            call show_progress(o%progress, 'SET '//whole(i)//': INSTANT', k, instant_count(a%now) - 1)
         if (.not. is_over(o, i)) cycle
         if (a%now%variants == 0) call break_off(o, a%now, say_broken_off, k)
         return
      end do
      if (lists) call put_answers(o%files(out_listing, 0), o%layout, asked, a)
      if (lists) call listing_end(o%files(out_listing, 0), a%now, row%solved, row%flagged, &
         a%certificate_counts, set_closure_error(a), set_closing_diagnostics(a))

   contains

      !> Writes instant number `k` of set number `i`, to which `a` has advanced; `due`: PRINT asks for it; `lists`:
      !> what there is of it stands in the listing. Only that, and estimates that are asked for, need samples.
      subroutine write_instant(due)
         logical, intent(in) :: due

         associate (shown => due .and. (lists .or. any(o%asked([out_csv, out_table, out_plot_table]))))
            if (shown .or. options%errors) call sample_set(a, options%errors)
            if (shown) call sense_set(a)
         end associate
         if (lists .and. (due .or. has_words(a%now))) &
            call listing_instant(o%files(out_listing, 0), o%layout, a%now, k, state)
         if (o%asked(out_csv) .and. due) call csv_instant(o%files(out_csv, 0), a%now, k, o%varies, a%assemblies)
         if (o%asked(out_table) .and. due) call table_instant(o%files(out_table, i), o%table, a%now)
         if (o%asked(out_plot_table) .and. due) call table_instant(o%files(out_plot_table, i), o%table, a%now)
         if (o%asked(out_log)) call put_log(o%files(out_log, 0))
         call write_parts(o)
      end subroutine write_instant

      !> The line of instant number `k` in the log.
      subroutine put_log(log)
         type(output_t), intent(inout) :: log
         type(convergence_t) :: record
         type(branch_t) :: branch

         call set_record(a, record, branch)
         if (options%errors) then
            call log_instant(log, k, instant(a%now, k), record, branch, set_errors(a))
         else
            call log_instant(log, k, instant(a%now, k), record, branch)
         end if
      end subroutine put_log
   end subroutine run_motion

   !> Ends the run before its time. The last line of the listing of `m` has the `words` and the `number` of the last
   !> instant, variant or set; nothing follows it.
   subroutine break_off(o, m, words, number)
      type(writers_t), intent(inout) :: o
      class(settings_t), intent(in) :: m
      type(phrase_t), intent(in) :: words
      integer, intent(in) :: number

      if (o%ended) return
      o%ended = .true.
      if (o%asked(out_listing)) call listing_broken_off(o%files(out_listing, 0), m, words, number)
   end subroutine break_off
end module set_runs
