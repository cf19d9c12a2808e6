!> One job: deck in, listing out. Solve an instant, write an instant; nothing is kept for later. Sets are independent of
!> one another, and long jobs compute them in several processes.
!>
!> The variants of a set with VARY cards: each is made when its turn comes, starts from the deck's own estimate and
!> leaves a row. So the row is the same whatever the others are, and memory does not grow with them. Where rows alone
!> are asked for, some are solved together. A variant that cannot be computed is a row that says so.
module job
   use, intrinsic :: iso_fortran_env, only: int64
   use, intrinsic :: iso_c_binding, only: c_int
   use kinds, only: wp
   use failures, only: failure_t, fail, status_rejected, status_solved, status_flagged, status_signal
   use mechanism, only: settings_t, mechanism_t, instant_count, instant, with_all_links
   use independent, only: set_t
   use structure, only: findings_t, check_structure, find_structure, find_groups, faults_text
   use deck, only: read_deck, build_variant
   use deck_variants, only: variation_t
   use system_calls, only: watch_signals, signal_received, write_bytes
   use text_output, only: output_t, put, flush_output, turn_lost
   use processes, only: processor_count, end_process
   use command_line
   use outputs, only: outputs_t, open_outputs, open_table, close_outputs, is_over
   use shares, only: run_shares, next_part, write_in_turn
   use listing, only: layout_t, new_layout, listing_state_t, listing_head, listing_instant, listing_end, put_untold, &
      remarks_text
   use column_table, only: column_table_t, new_column_table, note_columns, put_columns
   use csv, only: csv_head, csv_instant, table_t, new_table, table_head, table_instant
   use solver_log, only: log_head, log_instant
   use drawing, only: drawing_t, film_of, new_drawing, record_instant
   use svg, only: page_t, begin_page, end_page
   use picture, only: put_picture
   use animation, only: put_animation
   use circuits, only: circuits_t
   use set_circuits, only: find_all_circuits
   use circuits_picture, only: put_circuits
   use answers, only: answers_t, new_answers, take_instant, finish_answers
   use answer_tables, only: put_answers
   use counts, only: note_flag
   use variant_rows, only: summary_t, variant_row_t, new_summary, new_row, fill_row
   use variant_tables, only: summary_head, summary_row, put_variant, put_variant_heads, put_variant_row, &
      put_variants_end
   use lane_runs, only: lane_run_t, begin_run, run_lanes, width
   use lane_state, only: lanes_t
   use phrases, only: phrase_t, phrase, say_broken_set, say_broken_variant, say_broken_off
   use numerals, only: whole
   use motion_proof, only: holds
   use set_motion, only: new_set_motion, has_words
   use rows, only: finished_row_t, find_rows
   use set_analysis, only: set_analysis_t, make_set_analysis, renew_set_analysis, begin_analysis, advance_set, &
      sample_set, prove_set, set_certificates, set_closing_diagnostics
   use analysis, only: redundancy_error
   implicit none
   private
   public :: run_job

   !> Links times instants from which on more than one process is made: about a hundredth of a second.
   real, parameter :: least_work = 2.0e4

   !> The job's outputs, and what they keep from instant to instant.
   type, extends(outputs_t) :: writers_t
      type(options_t) :: options
      integer :: status = status_solved             !< the exit status of what was computed
      integer :: first = 1, last = 0                !< the sets that were read
      type(layout_t) :: layout                      !< of the listing of the set at hand
      type(table_t) :: table                        !< of the set at hand
      logical :: varies = .false.                   !< the deck has VARY cards
      type(variation_t), allocatable :: variations(:)   !< of all sets of the deck; empty without VARY cards
   end type writers_t

contains

   !> Does what `options` say. `status`: the exit status; `message`: lines for standard error, '' for none.
   subroutine run_job(options, status, message)
      type(options_t), intent(in) :: options
      integer, intent(out) :: status         !< exit status
      character(:), allocatable, intent(out) :: message !< lines for standard error
      ! Kept: the system takes back the memory of thousands of sets in a part of the time that freeing each would take.
      type(mechanism_t), allocatable, save :: sets(:)
      type(findings_t), allocatable, save :: findings(:)
      type(failure_t), allocatable :: failure
      type(writers_t) :: o
      integer(int64) :: variants
      real :: work
      integer :: i, processes, count_sets

      status = status_solved
      o%options = options
      call read_deck(options%deck, sets, message, failure, o%variations)
      o%varies = any(sets%variants > 0)
      ! A set without VARY cards counts as one variant.
      variants = sum(int(max(1, sets%variants), int64))
      if (.not. allocated(failure) .and. o%varies) then
         ! Of a deck with VARY cards there is no table, which has columns for one motion, and no picture of a part.
         ! Their numbers must be whole numbers of the default kind.
         if (variants > huge(1)) call fail(failure, status_rejected, &
            'TOO MANY VARIANTS IN ALL SETS: DIVIDE THE DECK')
         if (options%shares > 1 .and. (allocated(options%files(out_svg)%text) .or. &
            allocated(options%files(out_animation)%text))) call fail(failure, status_rejected, &
            'PICTURES OF A DECK WITH VARY CARDS CANNOT BE DIVIDED: OMIT --sets')
         if (allocated(options%files(out_table)%text)) call fail(failure, status_rejected, &
            'OPTION --table TAKES NO DECK WITH VARY CARDS: USE --summary OR --csv')
      end if
      if (.not. allocated(failure)) then
         o%share%first = int(variants*(options%share - 1)/options%shares) + 1
         o%share%last = int(variants*options%share/options%shares)
         count_sets = size(sets)
         o%first = merge(1, o%share%first, o%varies)
         o%last = merge(count_sets, o%share%last, o%varies)
         if (o%last - o%first + 1 < count_sets) sets = sets(o%first:o%last)
      end if
      if (.not. allocated(failure) .and. allocated(options%files(out_circuits)%text)) then
         if (.not. any(sets%circuits)) call fail(failure, status_rejected, &
            'OPTION --circuits NEEDS A SET WITH A CIRCUITS CARD')
      end if
      if (.not. allocated(failure)) call check_structure(sets, findings, failure)
      if (allocated(failure) .and. len(message) == 0) message = said()//' *** '//failure%text
      if (.not. allocated(failure)) then
         call open_outputs(options, o%first, o%last, count_sets, o, failure)
      end if
      if (.not. allocated(failure)) then
         call watch_signals
         o%share%kind = trim(merge('VARIANTS', 'SETS    ', o%varies))
         if (any([(are_together(sets(i), any(sets(i)%requests%every > 0 .or. sets(i)%requests%drive > 0), o), &
            i=1, size(sets))])) o%share%unit = width
         ! One process where sets take no time, or are to be drawn on one page, or nothing can be written.
         processes = options%jobs
         work = sum([(real(instant_count(sets(i)))*max(1, sets(i)%variants)*size(sets(i)%links), i=1, size(sets))])
         if (processes == 0) processes = merge(processor_count(), 1, work > least_work)
         if (options%check .or. any(o%asked([out_svg, out_animation, out_circuits])) .or. any(o%files%error /= 0)) &
            processes = 1
         processes = min(processes, sum(max(1, sets%variants)))
         if (processes > 1) call run_shares(o, processes, status, message)
         do while (next_part(o))
            call run_sets(sets, findings, o)
         end do
         call close_outputs(o, 1, out_shared)
         if (allocated(o%failure)) call move_alloc(o%failure, failure)
         status = max(status, o%status)
      end if
      if (allocated(failure)) then
         status = failure%status
         if (len(message) == 0) message = ' *** '//failure%text
      else if (len(message) == 0 .and. .not. (o%asked(out_listing) .or. o%share%is_child)) then
         message = said()
         ! The end of the last line comes with the message.
         message = message(:max(0, len(message) - 1))
      end if
      ! A run that a signal has ended ends by that signal.
      if (signal_received() > 0) status = status_signal + signal_received()
      if (.not. o%share%is_child) return
      ! A child ends here: its parent takes over the status, unless its turn has never come.
      if (any(o%files%error == turn_lost)) call end_process(status_solved)
      if (len(message) > 0) i = int(write_bytes(2_c_int, message//new_line('a')))
      call end_process(status)

   contains

      !> The remarks about `sets`, each line ended by new_line('a'), for where they stand in no listing; '' for --quiet.
      function said() result(text)
         character(:), allocatable :: text

         text = ''
         if (options%quiet) return
         do i = 1, size(sets)
            if (allocated(sets(i)%remarks)) text = text//remarks_text(sets(i))//new_line('a')
         end do
      end function said
   end subroutine run_job

   !> The sets of this share, one after another: shares put together in their order are the whole.
   subroutine run_sets(sets, findings, o)
      type(writers_t), intent(inout) :: o
      type(mechanism_t), intent(inout) :: sets(o%first:)
      type(findings_t), intent(inout) :: findings(o%first:)
      type(page_t), target :: pages(out_svg:out_circuits)
      type(set_analysis_t) :: a
      type(circuits_t), allocatable :: found(:)
      integer :: i, k, before

      if (o%asked(out_csv) .and. o%options%share == 1 .and. o%own_first == 1) &
         call csv_head(o%files(out_csv), o%options%errors, o%varies)
      do k = out_svg, out_circuits
         if (o%asked(k)) call begin_page(o%files(k), pages(k))
      end do
      before = o%first - 1
      ! Where no set has variants, those before the part at hand need not be passed over.
      if (.not. o%varies) before = o%own_first - 1
      do i = before + 1, o%last
         if (before >= o%own_last) exit
         associate (count => max(1, sets(i)%variants))
            if (before < o%own_last .and. before + count >= o%own_first) &
               call run_set(sets(i), i, o%own_first - before, o%own_last - before, findings(i), o)
            before = before + count
         end associate
         if (is_over(o)) then
            if (before > o%own_last) then
               call break_off(o, sets(i), say_broken_variant, o%own_last - before + sets(i)%variants)
            else if (i < o%last) then
               call break_off(o, sets(i), say_broken_set, sets(i)%set_number)
            end if
            exit
         end if
         ! Sets that were broken off are not drawn.
         if (o%asked(out_svg) .or. o%asked(out_animation)) call draw_set(sets(i), size(sets), o, pages)
         if (o%asked(out_circuits) .and. sets(i)%circuits) then
            ! As a picture, circuits have an analysis of their own.
            call make_set_analysis(sets(i), a)
            call advance_set(a, instant(sets(i), 0))
            call find_all_circuits(a, found)
            call put_circuits(pages(out_circuits), sets(i), a, found)
         end if
      end do
      do k = out_svg, out_circuits
         if (o%asked(k)) call end_page(o%files(k), pages(k))
      end do
   end subroutine run_sets

   !> Draws the film of `m`, one of so many `sets`, on those of the `pages` that are asked for. It has an analysis of
   !> its own: a picture shows links that no table asks for, and what is printed must not depend on it.
   subroutine draw_set(m, sets, o, pages)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: sets            !< their count
      type(writers_t), intent(inout) :: o
      type(page_t), intent(inout), target :: pages(out_svg:)
      type(mechanism_t) :: film
      type(drawing_t), target :: d
      type(set_analysis_t) :: a
      integer :: every, k

      call film_of(m, sets, film, every)
      d = new_drawing(film, every)
      call make_set_analysis(with_all_links(film), a)
      do k = 0, instant_count(film) - 1
         ! The first of the instants of AT, from which the deck's own motion goes on.
         if (every == 0 .and. k == film%steps + 1) call make_set_analysis(with_all_links(m), a)
         call advance_set(a, instant(film, k))
         call record_instant(d, a%now, k)
         if (signal_received() > 0) return
      end do
      if (o%asked(out_svg)) call put_picture(pages(out_svg), d)
      if (o%asked(out_animation)) call put_animation(pages(out_animation), d)
   end subroutine draw_set

   !> Solves and writes set number `i`, `m`: of its variants those from `first` to `last`, as far as it has them.
   subroutine run_set(m, i, first, last, findings, o)
      type(mechanism_t), intent(inout) :: m
      integer, intent(in) :: i, first, last  !< numbers of the set and of variants
      type(findings_t), intent(inout) :: findings
      type(writers_t), intent(inout) :: o
      type(failure_t), allocatable :: failure
      type(variant_row_t) :: counts
      type(set_analysis_t) :: a
      type(answers_t) :: asked

      call new_set_motion(m, a%now, findings)
      if (o%asked(out_listing) .and. first <= 1) then
         o%layout = new_layout(a%now)
         call find_groups(m, findings)
         call listing_head(o%files(out_listing), m, findings)
      end if
      ! It is as large as the deck, and only the head of the listing has it.
      if (allocated(m%echo)) deallocate (m%echo)
      if (o%options%check) return
      if (first <= 1) then
         call open_table(o%options, o%first, o%last, i, .false., o, failure)
         if (allocated(failure)) then
            call move_alloc(failure, o%failure)
            call break_off(o, m, say_broken_set, m%set_number - 1)
            return
         end if
         if (o%asked(out_log) .and. m%variants == 0) call log_head(o%files(out_log), m)
         if (o%asked(out_table)) then
            o%table = new_table(a%now)
            call table_head(o%files(out_table), o%table)
         end if
         ! An output that takes nothing is known before anything is computed.
         call flush_output(o%files)
      end if
      if (m%variants == 0) then
         call run_motion(a, findings, .true., o, counts, asked)
         if (counts%flagged + counts%unproved > 0) o%status = status_flagged
         call close_outputs(o, out_shared + 1, out_last)
      else
         call run_variants(a%now, max(1, first), min(m%variants, last), o%variations(i), o)
      end if
   end subroutine run_set

   !> Solves and writes the variants `first` to `last` of `v`, those of the set `m`.
   subroutine run_variants(m, first, last, v, o)
      class(set_t), intent(in) :: m
      integer, intent(in) :: first, last     !< numbers of variants
      type(variation_t), intent(inout) :: v
      type(writers_t), intent(inout) :: o
      type(layout_t) :: layout
      type(summary_t) :: summary
      type(variant_row_t) :: row
      type(mechanism_t) :: variant
      logical :: full, has_ratios
      integer :: n, k

      n = first
      full = any([(any(m%parts(k)%requests%every > 0), k=1, m%count)])
      has_ratios = any([(any(m%parts(k)%requests%drive > 0), k=1, m%count)])
      layout = new_layout(m)
      summary = new_summary(m, layout, v)
      if (o%asked(out_summary) .and. first == 1) call summary_head(o%files(out_summary), summary)
      if (o%asked(out_listing) .and. first == 1 .and. .not. full) then
         call put_variant_heads(o%files(out_listing), summary)
      end if
      if (are_together(m, full .or. has_ratios, o)) then
         call run_together()
      else
         do while (n <= last)
            row = new_row(summary, v, n)
            if (o%asked(out_listing) .and. full) call put_variant(o%files(out_listing), layout, summary, m, row)
            call run_variant(variant, row)
            if (is_over(o)) exit
            if (o%asked(out_listing) .and. full) call put_variant_heads(o%files(out_listing), summary)
            call write_row(row)
            n = n + 1
         end do
      end if
      if (n <= last) call break_off(o, m, say_broken_variant, n - 1)
      if (n > v%total .and. o%asked(out_listing)) call put_variants_end(o%files(out_listing), m)

   contains

      !> Solves and writes rows alone of the variants `n` to `last` of `v`, as many at a time as there are lanes; `n`:
      !> the first that is not written.
      subroutine run_together()
         ! Of a class, so that the compiler calls what makes and frees one, and does not write it out for each use.
         class(lane_run_t), allocatable :: runs(:)
         type(variant_row_t) :: rows(width)
         type(lanes_t) :: lanes
         integer :: k, count

         allocate (lane_run_t :: runs(width))
         do while (n <= last)
            count = min(width, last - n + 1)
            do k = 1, count
               rows(k) = new_row(summary, v, n + k - 1)
               call start(runs(k), rows(k))
            end do
            call run_lanes(runs(:count), lanes)
            do k = 1, count
               if (is_over(o)) return
               if (rows(k)%rejected == '') then
                  rows(k)%counts_t = runs(k)%counts
                  call fill_row(summary, runs(k)%s%now, runs(k)%asked, rows(k))
               else
                  call fill_row(summary, m, runs(k)%asked, rows(k))
               end if
               call write_row(rows(k))
               n = n + 1
            end do
         end do
      end subroutine run_together

      !> Makes the variant of `v` whose `row` this is, unless it is refused.
      subroutine start(r, row)
         type(lane_run_t), intent(inout) :: r
         type(variant_row_t), intent(inout) :: row
         type(findings_t) :: findings
         logical :: is_done

         call build_variant(v, row%number, r%m, row%rejected)
         r%is_over = row%rejected /= ''
         if (r%is_over) return
         ! A variant with the structure of the one before takes over what that has made.
         call renew_set_analysis(r%m, r%s, is_done)
         if (.not. is_done) then
            call check_variant(r%m, findings, row)
            r%is_over = row%rejected /= ''
            if (r%is_over) return
            call make_set_analysis(r%m, r%s, findings)
         end if
         call begin_run(r)
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

      !> Solves and writes the variant of `v` whose `row` this is: it is `variant` now. `full`: its
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
            if (o%asked(out_log)) call log_head(o%files(out_log), variant)
            call run_motion(a, findings, full, o, row, asked)
            call fill_row(summary, a%now, asked, row)
         else
            call fill_row(summary, m, asked, row)
         end if
      end subroutine run_variant

      !> Writes the `row` of a variant.
      subroutine write_row(row)
         type(variant_row_t), intent(in) :: row

         if (o%asked(out_summary)) call summary_row(o%files(out_summary), summary, m, row)
         if (o%asked(out_listing)) call put_variant_row(o%files(out_listing), layout, summary, m, row)
         call write_in_turn(o)
         if (row%flagged + row%unproved > 0 .or. row%rejected /= '') o%status = status_flagged
      end subroutine write_row
   end subroutine run_variants

   !> Whether rows alone are asked of the variants of the set `m`, which has what lanes do `not_have`, tables or ratios,
   !> or not: then as many are solved together as there are lanes.
   pure logical function are_together(m, not_have, o)
      class(settings_t), intent(in) :: m
      logical, intent(in) :: not_have        !< the set has tables or ratios, which lanes do not have
      class(outputs_t), intent(in) :: o

      are_together = m%variants > 0 .and. .not. (not_have .or. m%proves .or. o%asked(out_csv) .or. o%asked(out_log))
   end function are_together

   !> Solves and writes the set a%now, instant by instant; `full`: its tables too. `row`: how many instants are
   !> solved and flagged, and the first of those; `asked`: the answers to its cards.
   subroutine run_motion(a, findings, full, o, row, asked)
      type(set_analysis_t), intent(inout) :: a
      type(findings_t), intent(inout) :: findings
      logical, intent(in) :: full            !< with tables
      type(writers_t), intent(inout), target :: o
      type(variant_row_t), intent(inout) :: row
      type(answers_t), intent(out) :: asked
      type(listing_state_t) :: state
      type(column_table_t), target :: columns
      type(output_t), pointer :: page        ! for what is printed at the instants
      type(finished_row_t), allocatable :: rows(:)
      integer, allocatable :: every(:)       ! rows are printed at each so many instants
      logical :: lists, due, talks
      integer :: k, n, last, next            ! instants: the last, and the next with rows

      call begin_analysis(a, findings)
      allocate (rows(size(a%now%rows)))
      lists = full .and. o%asked(out_listing)
      if (o%asked(out_listing) .or. a%now%variants > 0) call new_answers(a, lists, asked)
      if (lists) call new_column_table(o%layout, a%now, columns)
      page => o%files(out_listing)
      if (columns%alone) page => columns%remarks
      every = [(merge(1, a%now%parts(n)%requests%every, a%now%parts(n)%requests%in_columns), n=1, a%now%count)]
      every = pack(every, every > 0)
      last = instant_count(a%now) - 1
      next = merge(0, huge(next), size(every) > 0)
      do k = 0, last
         call advance_set(a, instant(a%now, k))
         due = k == next .or. (k == last .and. size(every) > 0)
         ! A division for each request at every instant would take longer than all else here.
         if (k == next) next = k + minval(every - mod(k, every))
         if (a%now%proves) then
            call prove_set(a, due)
            if (.not. all(holds(a%now%proofs))) row%unproved = row%unproved + 1
         end if
         call note_flag(row%counts_t, a)

         ! Only what is shown needs samples.
         if (o%asked(out_table) .or. (due .and. (lists .or. o%asked(out_csv)))) call sample_set(a, o%options%errors)
         talks = lists .and. (due .or. has_words(a%now))
         if (talks .or. o%asked(out_table) .or. (due .and. o%asked(out_csv))) &
            call find_rows(a%now, k, o%asked(out_table) .or. allocated(columns%columns), rows, a%assemblies)
         if (talks) call listing_instant(page, o%layout, a%now, rows, k, state)
         if (allocated(columns%columns)) call note_columns(columns, o%layout, a%now, rows)
         if (o%asked(out_csv) .and. due) call csv_instant(o%files(out_csv), a%now, rows, k, o%varies)
         if (o%asked(out_table)) call table_instant(o%files(out_table), o%table, a%now, rows)
         if (o%asked(out_log)) then
            do n = 1, size(a%list)
               call log_instant(o%files(out_log), k, instant(a%now, k), a%list(n)%convergence, a%list(n)%branch)
            end do
         end if
         call write_in_turn(o)

         call take_instant(asked, a, rows, k, due)
         if (.not. is_over(o)) cycle
         if (lists) call put_untold(page, a%now%polish, state)
         if (lists) call put_columns(o%files(out_listing), columns, a%now%polish)
         if (a%now%variants == 0) call break_off(o, a%now, say_broken_off, k)
         return
      end do
      if (lists) call put_untold(page, a%now%polish, state)
      if (lists) call put_columns(o%files(out_listing), columns, a%now%polish)
      if (lists) call finish_answers(asked, a)
      if (lists) call put_answers(o%files(out_listing), o%layout, asked, a)
      if (lists) call listing_end(o%files(out_listing), a%now, row%solved, row%flagged, set_certificates(a), &
         maxval([(redundancy_error(a%list(n)), n=1, size(a%list))]), set_closing_diagnostics(a))
   end subroutine run_motion

   !> Ends the run before its time. The last line of the listing of `m` has the `words` and the `number` of the last
   !> instant, variant or set; nothing follows it.
   subroutine break_off(o, m, words, number)
      type(writers_t), intent(inout) :: o
      class(settings_t), intent(in) :: m
      type(phrase_t), intent(in) :: words
      integer, intent(in) :: number          !< from 1; of an instant from 0

      if (o%ended) return
      o%ended = .true.
      if (.not. o%asked(out_listing)) return
      call put(o%files(out_listing), '')
      call put(o%files(out_listing), ' *** '//phrase(words, m%polish)//' '//whole(number))
   end subroutine break_off
end module job
