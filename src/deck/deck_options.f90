!> Options, instants and requests of a set: the cards TITLE, UNITS, LANG and METHOD; TIME and AT; PRINT, COLUMN,
!> EXTREMES, RANGE, CIRCUITS, ASSEMBLY, PROVE, BRANCH, POLE and CURVE.
module deck_options
   use kinds, only: wp
   use parameters, only: angle_in_radians
   use mechanism
   use card_sets, only: card_set_t, has_drawing, look_up, look_up_kinds, match_word, add_card_error
   use columns, only: columns_of_rows, form_of, forms, kinds_of_rows, quantities
   use cards
   use input_errors
   use name_table, only: name_table_t, store_name, find_name
   use number_format, only: whole
   use independent, only: part_of_links
   implicit none
   private
   public :: build_options, build_requests, build_branches, check_centres

   !> The largest number of steps that the field of a TIME card can hold.
   integer, parameter :: max_steps = 99999999
   !> A relative tolerance on a METHOD card is above this: less than some roundings of doubles, or in real128 of its own
   !> kind, means nothing.
   real(wp), parameter :: min_tolerance = min(1.0e-15_wp, 5.0_wp*epsilon(1.0_wp))
   !> The largest relative tolerance on a METHOD card: with more, the result is no solution.
   real(wp), parameter :: max_tolerance = 1.0e-2_wp
   !> The smallest closing tolerance (characteristic lengths, rad): equations that agree so well need none.
   real(wp), parameter :: min_closing = 1.0e-10_wp
   !> The largest closing tolerance (characteristic lengths, rad): with more, the result is no solution.
   real(wp), parameter :: max_closing = 1.0e-2_wp
   !> The word of a TIME card that counts turns of a drive.
   character(*), parameter :: turns_word = 'TURNS'
   !> Words that can only be meant as a unit of angles, in any field of UNITS.
   character(7), parameter :: angle_words(*) = [character(7) :: 'DEG', 'RAD', 'GRAD', 'DEGREE', 'DEGREES', 'RADIAN', &
      'RADIANS']
   !> The forms of cards of requests, in the order in which they are read.
   integer, parameter :: read_order(*) = [form_print, form_column, form_extremes, form_pole, form_curve]
   !> The words of PRINT and EXTREMES: 0 for everything, then the kinds request_link to request_measure.
   character(*), parameter :: print_words(0:request_measure) = &
      [character(8) :: 'ALL', 'LINKS', 'POINTS', 'PAIRS', 'MEASURES']
   !> The word of PRINT, COLUMN and EXTREMES for ratios of pairs or measures.
   character(*), parameter :: ratio_word = 'RATIOS'
   !> The number of this word, after the kinds.
   integer, parameter :: word_ratio = request_measure + 1

contains

   !> Sets the options and instants of a mechanism from its cards. Repeated cards, unknown words and values out of range
   !> are errors.
   subroutine build_options(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      real(wp) :: instants(3*set%number_of(form_at))
      integer :: first(size(card_forms)), k, i, n, chosen

      first = 0
      n = 0
      do k = 1, set%count
         associate (card => set%cards(k), label => set%cards(k)%label, m => set%mechanism)
            if (card%form == form_unknown) cycle
            if (first(card%form) == 0) first(card%form) = k
            if (card_forms(card%form)%once .and. first(card%form) < k) &
               call add_card_error(set, card_repeated, k, card_name, whole(set%cards(first(card%form))%card%number))

            select case (card%form)
            case (form_title)
               m%title = card%card%text(title_field%first:title_field%last)
            case (form_units)
               if (label(label_a) /= '') m%length_unit = label(label_a)
               if (label(label_c) /= '') m%time_unit = label(label_c)
               m%degrees = label(label_b) == 'DEG'
               if (.not. card%valid) cycle
               ! DEG as the unit of length would leave all angles in radians.
               do i = label_a, label_c, 2
                  if (any(label(i) == angle_words)) call add_card_error(set, units_place, k, i)
               end do
               if (all(label(label_b) /= ['   ', 'RAD', 'DEG'])) &
                  call add_card_error(set, word_unknown, k, label_b, 'RAD, DEG')

            case (form_lang)
               call match_word(set, k, ['EN', 'PL'], chosen)
               m%polish = chosen == 2

            case (form_method)
               if (.not. card%valid) cycle
               chosen = 0
               if (label(label_a) /= '') call match_word(set, k, method_words, chosen)
               if (chosen > 0) m%method = chosen
               m%tolerance = card%real(1)
               if (m%tolerance < 0.0_wp .or. m%tolerance > max_tolerance .or. &
                   (m%tolerance > 0.0_wp .and. m%tolerance <= min_tolerance)) &
                  call add_card_error(set, number_range, k, real_1, 'ABOVE 1E-15, UP TO 1E-2')
               m%closing = card%real(2)
               if (abs(m%closing) > 0.0_wp .and. (m%closing < min_closing .or. m%closing > max_closing)) then
                  call add_card_error(set, number_range, k, real_2, '1E-10 TO 1E-2')
               else if (m%closing > 0.0_wp .and. m%method /= method_newton) then
                  call add_card_error(set, newton_needed, k, real_2)
               end if

            case (form_time)
               if (.not. card%valid) cycle
               if (card%whole < 1 .or. card%whole > max_steps) then
                  call add_card_error(set, number_range, k, label_a, '1 TO '//whole(max_steps))
               else if (all(label(label_b) /= ['     ', turns_word])) then
                  call add_card_error(set, word_unknown, k, label_b, turns_word)
               else if (.not. (card%given(2) .or. (card%given(1) .and. label(label_b) == ''))) then
                  call add_card_error(set, field_blank, k, real_2)

               else if (label(label_b) == turns_word) then
                  m%steps = card%whole
                  m%t0 = card%real(1)
                  m%turns = card%real(2)
                  if (.not. m%turns > 0.0_wp) call add_card_error(set, number_range, k, real_2, 'ABOVE 0.0')
               else if (.not. abs(card%real(2) - card%real(1)) > 0.0_wp) then
                  call add_card_error(set, time_point, k, real_2)
               else
                  m%steps = card%whole
                  m%t0 = card%real(1)
                  m%t1 = card%real(2)
               end if

            case (form_at)
               if (card%valid .and. .not. any(card%given)) call add_card_error(set, field_blank, k, real_1)
               instants(n + 1:n + count(card%given)) = pack(card%real, card%given)
               n = n + count(card%given)
            end select
         end associate
      end do

      set%mechanism%at = instants(:n)
      set%mechanism%ranges = set%number_of(form_range) > 0
      set%mechanism%assemblies = set%number_of(form_assembly) > 0
      set%mechanism%circuits = set%number_of(form_circuits) > 0
      set%mechanism%proves = set%number_of(form_prove) > 0
      do k = 1, set%count
         if (set%cards(k)%form == form_prove .and. set%mechanism%method /= method_newton) &
            call add_card_error(set, newton_needed, k, card_name)
      end do
   end subroutine build_options

   !> Builds the requests of a mechanism from its PRINT, COLUMN, EXTREMES, POLE and CURVE cards, each kind of cards in
   !> the order of the deck. Bodies, measures and drives must have been built. For a subject of several PRINT or
   !> EXTREMES cards the first card counts. Unknown words and names and repeated cards are errors.
   !>
   !> Without a PRINT or COLUMN card, all links that are not ground and all measures are printed. The listing of a
   !> drawing then has its points as well, and only the angle of links without axes of their own.
   subroutine build_requests(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      type(name_table_t) :: seen(0:word_ratio)      ! for each word, the names on earlier cards of one form
      type(request_t), allocatable :: requests(:)
      type(column_request_t), allocatable :: columns(:)
      integer, allocatable :: number(:, :)          ! (number, kind) the request of a subject; 0: none yet
      integer, allocatable :: column_cards(:)       ! (columns) their cards
      integer, allocatable :: part(:)               ! (links) their parts; allocated if ratios need them
      integer :: k, n, i, j

      associate (sizes => [(size(set%named(k)%card), k=request_link, request_measure)])
         allocate (requests(sum(sizes) + sum(set%number_of([form_pole, form_curve]))))
         allocate (number(maxval(sizes), request_link:request_measure), source=0)
      end associate

      n = 0
      allocate (columns(0), column_cards(0))
      ! In a set of variants COLUMN cards print no rows: links and measures are requested without rows.
      if (set%number_of(form_print) == 0 .and. (set%number_of(form_column) == 0 .or. set%number_of(form_vary) > 0)) then
         call request_all(request_t(request_link, every=merge(0, 1, set%number_of(form_vary) > 0)))
         if (set%number_of(form_joint) > 0 .and. set%number_of(form_vary) == 0) then
            ! The axes of a link without axes of its own are the axes of the drawing: its x and y show the drawing's
            ! origin, moved with the link. The listing has points instead.
            do i = 1, n
               requests(i)%angle_alone = .not. has_axes(requests(i)%subject)
            end do
            call request_all(request_t(request_point, every=0, listed=.true.))
         end if
         call request_all(request_t(request_measure, every=merge(0, 1, set%number_of(form_vary) > 0)))
      end if

      do i = 1, size(read_order)
         seen = name_table_t()
         do k = 1, set%count
            if (set%cards(k)%form /= read_order(i) .or. .not. set%cards(k)%valid) cycle
            select case (read_order(i))
            case (form_print)
               call read_subjects(k, request_t(every=every(k)))
            case (form_column)
               call read_column(k)
            case (form_extremes)
               if (set%mechanism%steps < 0 .and. set%number_of(form_time) == 0 .and. set%names_certain) &
                  call add_card_error(set, extremes_time, k, card_name)
               do j = 1, 2
                  if (set%cards(k)%real(j) < 0.0_wp) &
                     call add_card_error(set, number_range, k, real_1 + j - 1, '0.0 AND UP')
               end do
               call read_subjects(k, request_t(every=0, extremes=.true., &
                  dwell=set%cards(k)%real(:2)*[1.0_wp, angle_in_radians(set%mechanism)]))

            case default
               n = n + 1
               requests(n) = request_t(merge(request_pole, request_curve, read_order(i) == form_pole), every=every(k))
               associate (one => requests(n))
                  if (one%kind == request_pole) then
                     call look_up(set, request_link, k, label_a, one%second)
                     call look_up(set, request_link, k, label_b, one%subject)
                  else
                     call look_up(set, request_point, k, label_a, one%subject)
                     call look_up(set, request_link, k, label_b, one%second)
                  end if
               end associate
               set%cards(k)%subject = n
            end select
         end do
      end do
      if (size(columns) > 0) set%mechanism%columns = columns
      set%mechanism%requests = requests(:n)

   contains

      !> Gives the number of instants from one row to the next that a PRINT, POLE or CURVE card requests; 1 if blank. A
      !> number below 1 is an error.
      integer function every(k)
         integer, intent(in) :: k            !< number of the card

         every = merge(set%cards(k)%whole, 1, set%cards(k)%whole_given)
         if (every < 1) call add_card_error(set, number_range, k, label_c, '1 AND UP')
      end function every

      !> Adds a request for each subject of a PRINT or EXTREMES card. Errors are an unknown word or name, a repeated
      !> card, and extremes of the ground.
      subroutine read_subjects(k, request)
         integer, intent(in) :: k            !< number of the card
         type(request_t), intent(in) :: request   !< without kind and subject
         type(request_t) :: one
         integer, allocatable :: links(:), ratios(:)
         integer :: earlier, chosen, kind, added

         call match_word(set, k, [character(8) :: print_words, ratio_word], chosen)
         if (chosen == 0) return
         one = request
         one%kind = chosen - 1

         associate (name => set%cards(k)%label(label_b))
            call store_name(seen(one%kind), name, k, earlier)
            if (earlier > 0) then
               call add_card_error(set, repeated, k, label_a, whole(set%cards(earlier)%card%number))
            else if (one%kind == 0 .and. name /= '') then
               call add_card_error(set, field_unused, k, label_b)
            else if (one%kind == 0) then
               if (one%extremes .and. size(columns) > 0) then
                  call seek_columns(one)
                  return
               end if
               do kind = request_link, request_measure
                  one%kind = kind
                  call request_all(one)
               end do

            else if (one%kind == word_ratio) then
               call read_ratios(k, one, ratios)
            else if (name == '') then
               if (size(set%named(one%kind)%card) == 0 .and. set%names_certain) &
                  call add_card_error(set, word_unknown, k, label_a, 'THE ITEMS OF THIS SET')
               call request_all(one)

            else
               call look_up(set, one%kind, k, label_b, one%subject)
               if (one%subject == 0) return
               ! A pair always moves. The links of a measure are certain only in a deck without errors.
               if (one%extremes .and. one%kind /= request_pair .and. &
                   (one%kind /= request_measure .or. set%errors%count == 0)) then
                  links = request_links(set%mechanism, one)
                  links = pack(links, links > 0)
                  if (size(links) > 0 .and. all(set%mechanism%links(links)%ground)) &
                     call add_card_error(set, is_ground, k, label_b)
               end if
               call add_request(one, added)
            end if
         end associate
      end subroutine read_subjects

      !> Adds a request for each link, point, pair or measure of a kind, except ground links. A JOINT card has one
      !> point.
      subroutine request_all(request)
         type(request_t), intent(in) :: request   !< of this kind, without a subject
         type(request_t) :: one
         integer :: i, j

         one = request
         do i = 1, size(set%named(one%kind)%card)
            if (one%kind == request_link) then
               if (set%mechanism%links(i)%ground) cycle
            else if (one%kind == request_point) then
               ! Of the two points of a JOINT card, only the point for which its name stands.
               if (find_name(set%named(one%kind)%table, set%mechanism%points(i)%name) /= i) cycle
            end if
            one%subject = i
            one%sought = .true.
            ! Extremes of x and y of axes that no card has placed are not sought.
            if (one%kind == request_link .and. has_drawing(set)) one%sought(:2, :) = has_axes(i)
            call add_request(one, j)
         end do
      end subroutine request_all

      !> Adds a request. If its row has a request already, the earlier request gets the extremes: of the numbers that
      !> the new request seeks, and of the numbers that COLUMN cards name.
      subroutine add_request(request, i)
         type(request_t), intent(in) :: request   !< with its kind and its subject
         integer, intent(out) :: i           !< number of the request of this row

         if (request%drive == 0) then
            i = number(request%subject, request%kind)
         else
            i = findloc(requests(:n)%drive == request%drive .and. requests(:n)%kind == request%kind .and. &
               requests(:n)%subject == request%subject, .true., dim=1)
         end if
         if (i == 0) then
            ! Only ratios need more room than was allocated.
            if (request%drive > 0) requests = [requests, request]
            n = n + 1
            i = n
            requests(i) = request
            requests(i)%extremes = .false.
            if (request%drive == 0) number(request%subject, request%kind) = i
         end if
         if (.not. request%extremes) return

         if (.not. requests(i)%extremes) then
            requests(i)%dwell = request%dwell
            requests(i)%sought = numbers_in_columns(i)
         end if
         requests(i)%extremes = .true.
         requests(i)%sought = requests(i)%sought .or. request%sought
      end subroutine add_request

      !> Tells whether the card of a link gives the position of its axes: by numbers, or by FROM and TO.
      pure logical function has_axes(i)
         integer, intent(in) :: i            !< the number of the link

         has_axes = any(set%cards(set%named(request_link)%card(i))%given) .or. set%mechanism%links(i)%from > 0
      end function has_axes

      !> Reads a COLUMN card: one number of a row or, if the card names no quantity, all coordinates of the row. For a
      !> link without axes of its own the only coordinate is the angle. An unknown word, name or quantity, and a
      !> repeated column, are errors.
      subroutine read_column(k)
         integer, intent(in) :: k            !< the number of the card in the set
         type(request_t) :: request
         character(:), allocatable :: words
         integer :: chosen, i, j, first

         call match_word(set, k, [character(8) :: print_words(request_link:), ratio_word], chosen)
         if (chosen == 0) return
         if (chosen == word_ratio) then
            call read_ratio_columns(k)
            return
         end if
         request = request_t(chosen, every=0)
         call look_up(set, chosen, k, label_b, request%subject)
         if (request%subject == 0) return
         call add_request(request, i)
         requests(i)%in_columns = .true.

         first = size(columns)
         words = ''
         associate (form => forms(form_of(set%mechanism, request)), quantity => set%cards(k)%label(label_c))
            do j = form%first, form%last
               associate (column => columns_of_rows(j), word => quantity_of(form_of(set%mechanism, request), j))
                  if (j > form%first) words = words//', '
                  words = words//trim(word)
                  if (quantity == word) call add_column(k, column_request_t(i, column%at))
                  if (quantity /= '' .or. column%order > 0) cycle
                  if (chosen == request_link .and. has_drawing(set) .and. column%at(1) < 3) then
                     if (.not. has_axes(request%subject)) cycle
                  end if
                  call add_column(k, column_request_t(i, column%at))
               end associate
            end do
         end associate
         if (size(columns) == first .and. set%cards(k)%label(label_c) /= '') &
            call add_card_error(set, word_unknown, k, label_c, words)
      end subroutine read_column

      !> Adds a request for each ratio that a card names: of one pair or measure, or of all pairs and measures. An
      !> unknown name is an error.
      subroutine read_ratios(k, request, list)
         integer, intent(in) :: k            !< the number of the card in the set
         type(request_t), intent(in) :: request   !< without kind and subject
         integer, allocatable, intent(out) :: list(:)   !< (any number) the numbers of the requests for these ratios
         integer :: kind, subject

         allocate (list(0))
         if (set%cards(k)%label(label_b) /= '') then
            call look_up_kinds(set, [request_pair, request_measure], summand_unknown, k, label_b, kind, subject)
            if (subject > 0) call add_ratios(k, request, kind, subject, list)
         else
            do kind = request_pair, request_measure
               do subject = 1, size(set%named(kind)%card)
                  call add_ratios(k, request, kind, subject, list)
               end do
            end do
         end if
      end subroutine read_ratios

      !> Adds a request for the ratio of a pair or measure by each drive of its independent mechanism. The structure
      !> shows later which of these drives can move the pair or measure. Extremes with several drives are an error. In a
      !> deck with errors nothing is added.
      subroutine add_ratios(k, request, kind, subject, list)
         integer, intent(in) :: k            !< the number of the card in the set
         type(request_t), intent(in) :: request   !< without kind and subject
         integer, intent(in) :: kind         !< request_pair or request_measure
         integer, intent(in) :: subject      !< number of the pair or measure
         integer, allocatable, intent(inout) :: list(:)   !< (any number) gets these requests' numbers
         type(request_t) :: one
         integer :: i, j

         ! The links of the quantity are certain only in a deck without errors.
         if (set%errors%count > 0) return
         one = request
         one%kind = kind
         one%subject = subject
         one%drive = 0
         associate (drives => drives_of(one))
            if (one%extremes .and. size(drives) > 1) then
               call add_card_error(set, ratio_drives, k, merge(label_b, label_a, set%cards(k)%label(label_b) /= ''))
               return
            end if
            do i = 1, size(drives)
               one%drive = drives(i)
               call add_request(one, j)
               list = [list, j]
            end do
         end associate
      end subroutine add_ratios

      !> Finds the drives of the independent mechanism to which the pair or measure of a request belongs.
      function drives_of(request) result(list)
         type(request_t), intent(in) :: request   !< of a pair or measure
         integer, allocatable :: list(:)     !< (any number) their numbers
         integer :: own, i

         if (.not. allocated(part)) part = part_of_links(set%mechanism)
         associate (m => set%mechanism)
            own = maxval(part(request_links(m, request)))
            list = pack([(i, i=1, size(m%drives))], &
               [(own > 0 .and. maxval(part(drive_links(m, m%drives(i)))) == own, i=1, size(m%drives))])
         end associate
      end function drives_of

      !> Reads a COLUMN card of ratios: the ratio (VALUE or blank) or its derivative (DERIV), by each drive. Any other
      !> quantity is an error.
      subroutine read_ratio_columns(k)
         integer, intent(in) :: k            !< the number of the card in the set
         integer, allocatable :: list(:)
         integer :: i, order

         order = findloc(['VALUE', 'DERIV'], set%cards(k)%label(label_c), dim=1) - 1
         if (set%cards(k)%label(label_c) == '') order = 0
         if (order < 0) then
            call add_card_error(set, word_unknown, k, label_c, 'VALUE, DERIV')
            return
         end if
         call read_ratios(k, request_t(every=0), list)
         do i = 1, size(list)
            requests(list(i))%in_columns = .true.
            call add_column(k, column_request_t(list(i), [1, order]))
         end do
      end subroutine read_ratio_columns

      !> Adds a column of a COLUMN card. A column that an earlier card has added is an error.
      subroutine add_column(k, column)
         integer, intent(in) :: k            !< the number of the card in the set
         type(column_request_t), intent(in) :: column   !< of a request of the set
         integer :: i

         i = findloc(columns%request == column%request .and. columns%at(1) == column%at(1) .and. &
            columns%at(2) == column%at(2), .true., dim=1)
         if (i > 0) call add_card_error(set, repeated, k, label_b, whole(set%cards(column_cards(i))%card%number))
         columns = [columns, column]
         column_cards = [column_cards, k]
      end subroutine add_column

      !> Tells of each number (3, 0:2) of a request whether a COLUMN card names it.
      pure function numbers_in_columns(i) result(named)
         integer, intent(in) :: i            !< the number of the request
         logical :: named(3, 0:2)
         integer :: k

         named = .false.
         do k = 1, size(columns)
            if (columns(k)%request == i) named(columns(k)%at(1), columns(k)%at(2)) = .true.
         end do
      end function numbers_in_columns

      !> Adds extremes to the requests of all rows in columns: of the numbers that COLUMN cards name. A request that has
      !> extremes of an earlier card stays as it is.
      subroutine seek_columns(request)
         type(request_t), intent(in) :: request   !< with its dwells; kind and subject do not count
         integer :: i

         do i = 1, n
            if (.not. requests(i)%in_columns .or. requests(i)%extremes) cycle
            ! Ratios in a mechanism with several drives are not searched.
            if (requests(i)%drive > 0) then
               if (size(drives_of(requests(i))) > 1) cycle
            end if
            requests(i)%extremes = .true.
            requests(i)%dwell = request%dwell
            requests(i)%sought = numbers_in_columns(i)
         end do
      end subroutine seek_columns
   end subroutine build_requests

   !> Builds the branch requests of a mechanism from its BRANCH cards, in their order. Links and options must have been
   !> built. Errors are another method than NEWTON, an unknown or ground link, a blank time, and the link and time of an
   !> earlier card, which may be meant for the next change point.
   subroutine build_branches(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      type(branch_request_t) :: requests(set%number_of(form_branch))
      integer :: card_of(set%number_of(form_branch)), k, n, i

      n = 0
      do k = 1, set%count
         if (set%cards(k)%form /= form_branch .or. .not. set%cards(k)%valid) cycle
         n = n + 1
         card_of(n) = k
         associate (request => requests(n))
            if (set%mechanism%method /= method_newton) call add_card_error(set, newton_needed, k, card_name)
            call look_up(set, request_link, k, label_a, request%link)
            if (request%link > 0) then
               if (set%mechanism%links(request%link)%ground) call add_card_error(set, is_ground, k, label_a)
            end if
            if (.not. set%cards(k)%given(1)) call add_card_error(set, field_blank, k, real_1)
            request%t = set%cards(k)%real(1)
         end associate

         i = findloc(requests(:n - 1)%link == requests(n)%link &
            .and. .not. abs(requests(:n - 1)%t - requests(n)%t) > 0.0_wp, .true., dim=1)
         if (i > 0) call add_card_error(set, repeated, k, card_name, whole(set%cards(card_of(i))%card%number))
      end do
      set%mechanism%branch_requests = requests(:n)
   end subroutine build_branches

   !> Checks the poles and curves of a set without errors. Two links without relative motion, or of two independent
   !> mechanisms, are an error. A link that nothing uses must have become ground before.
   subroutine check_centres(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      type(request_t) :: one
      integer, allocatable :: part(:)
      integer, allocatable :: links(:)
      integer :: k

      if (sum(set%number_of([form_pole, form_curve])) == 0) return
      part = part_of_links(set%mechanism)
      do k = 1, set%count
         if (all(set%cards(k)%form /= [form_pole, form_curve])) cycle
         one = set%mechanism%requests(set%cards(k)%subject)
         links = request_links(set%mechanism, one)
         associate (parts => [part(links(1)), merge(part(links(3)), 0, one%second > 0)])
            if (links(1) == one%second .or. maxval(parts) == 0) then
               call add_card_error(set, centre_still, k, card_name)
            else if (parts(1) /= parts(2) .and. minval(parts) > 0) then
               call add_card_error(set, centre_apart, k, label_b)
            end if
         end associate
      end do
   end subroutine check_centres

   !> Gives the word of a column on COLUMN cards: VALUE, VX, PHI, ...
   pure character(8) function quantity_of(form, j) result(word)
      integer, intent(in) :: form            !< of the rows: row_link, ...
      integer, intent(in) :: j               !< index of the column in `columns_of_rows`

      word = kinds_of_rows(forms(form)%kind)%quantities(columns_of_rows(j)%order)
      if (word == '') word = columns_of_rows(j)%english(:len(word))
   end function quantity_of
end module deck_options
